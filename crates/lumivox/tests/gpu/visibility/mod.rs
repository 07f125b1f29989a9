//! Visibility fields on the GPU: look-ups against the CPU's, and occlusion and reflections against closed forms.

mod objects;
mod occlusion;
mod query;
mod reflection;
mod shadow;

use crate::Test;

pub(crate) fn tests() -> Vec<Test> {
    [query::TESTS, occlusion::TESTS, shadow::TESTS, reflection::TESTS].concat()
}
