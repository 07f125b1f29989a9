//! Scenes from the folder `LUMIVOX_ASSETS`.
fn main() {}
