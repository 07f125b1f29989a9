//! Progress on a terminal, and milliseconds per stage.

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use indicatif::ProgressBar;
use lumivox_voxels::{Progress, Stage};

use crate::stats::StageStats;
use crate::{clock, render};

/// What is under way, and how long everything before it took.
pub(super) struct Stages {
    bar: ProgressBar,
    inner: Mutex<Inner>,
}

struct Inner {
    now: &'static str,
    since: f64,
    done: Vec<StageStats>,
}

impl Stages {
    /// Starts with a stage.
    pub(super) fn start(stage: &'static str) -> Self {
        let inner = Inner { now: stage, since: clock::millis(), done: Vec::new() };
        Self { bar: render::progress(0, stage), inner: Mutex::new(inner) }
    }

    /// Goes on to another stage, or stays in this one.
    pub(super) fn enter(&self, stage: &'static str) {
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        if inner.now != stage {
            inner.leave();
            inner.now = stage;
            self.bar.set_message(stage);
        }
    }

    /// The voxelizer's own stages.
    pub(super) fn report(&self, progress: Progress) -> ControlFlow<()> {
        self.enter(match progress.stage {
            Stage::Binning => "binning",
            Stage::Cells => "cells",
            Stage::Filling => "filling",
        });
        self.bar.set_length(progress.total);
        self.bar.set_position(progress.done);
        ControlFlow::Continue(())
    }

    /// Ends the last stage; the times of all, each once.
    pub(super) fn finish(self) -> Vec<StageStats> {
        self.bar.finish_and_clear();
        let mut inner = self.inner.into_inner().unwrap_or_else(PoisonError::into_inner);
        inner.leave();
        inner.done
    }
}

impl Inner {
    fn leave(&mut self) {
        let now = clock::millis();
        let ms = now - self.since;
        match self.done.iter_mut().find(|stage| stage.stage == self.now) {
            Some(stage) => stage.ms += ms,
            None => self.done.push(StageStats { stage: self.now, ms }),
        }
        self.since = now;
    }
}
