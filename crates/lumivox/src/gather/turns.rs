//! Which surfels have their turn in a frame.

/// What a frame's shaders are told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FrameTurns {
    /// Part of all surfels, in units of 2^-32; `u32::MAX` is all.
    pub(super) share: u32,
    /// Where on the circle of turns it begins.
    pub(super) phase: u32,
    /// Frames until the next turn, where all take it together; else 0.
    pub(super) frames_left: u32,
}

/// Turns that go round.
#[derive(Debug, Default)]
pub(super) struct Turns {
    phase: u32,
}

impl Turns {
    /// The next frame of rounds of `frames` frames.
    pub(super) fn next(&mut self, frames: f32) -> FrameTurns {
        if frames <= 1.0 {
            return Self::nth(0, 1);
        }
        // No share is 0, which would wait for ever.
        let share = (2f64.powi(32) / f64::from(frames)).clamp(1.0, f64::from(u32::MAX)) as u32;
        let phase = self.phase;
        self.phase = phase.wrapping_add(share);
        FrameTurns { share, phase, frames_left: 0 }
    }

    /// Frame `n` where all have their turn in every `every`-th frame.
    pub(super) fn nth(n: u32, every: u32) -> FrameTurns {
        let every = every.max(1);
        let since = n % every;
        FrameTurns { share: if since == 0 { u32::MAX } else { 0 }, phase: 0, frames_left: every - since }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `turn.wgsl` has it.
    fn has_turn(run: u32, turns: FrameTurns) -> bool {
        let ahead = run.wrapping_mul(2_654_435_769).wrapping_sub(turns.phase);
        turns.share == u32::MAX || ahead < turns.share
    }

    #[test]
    fn all_have_one_turn_in_each_round_and_parts_are_even() {
        const RUNS: u32 = 1000;
        for frames in [2u32, 4, 7, 64] {
            let mut turns = Turns::default();
            for _ in 0..3 {
                let mut had = vec![0u32; RUNS as usize];
                for _ in 0..frames {
                    let now = turns.next(frames as f32);
                    let count = (0..RUNS)
                        .filter(|&run| has_turn(run, now))
                        .inspect(|&r| had[r as usize] += 1)
                        .count();
                    let even = f64::from(RUNS) / f64::from(frames);
                    assert!(
                        (count as f64 - even).abs() <= 3.0,
                        "{count} of {even} in one of {frames} frames"
                    );
                }
                // A share is rounded down, so that a round may end a few units short.
                assert!(had.iter().filter(|&&n| n == 1).count() >= RUNS as usize - 1, "{frames} frames");
            }
        }
    }

    #[test]
    fn nobody_waits_when_the_number_of_frames_changes() {
        let mut turns = Turns::default();
        let mut since = vec![0u32; 500];
        for n in 0..400u32 {
            let now = turns.next(4.0 + 3.0 * (f32::from(n as u16) * 0.37).sin());
            for (run, since) in since.iter_mut().enumerate() {
                *since = if has_turn(run as u32, now) { 0 } else { *since + 1 };
                assert!(*since < 8, "run {run} has waited {since} frames of rounds of at most seven");
            }
        }
    }

    #[test]
    fn every_nth_frame_is_whole_and_the_others_count_down() {
        let left: Vec<(bool, u32)> =
            (0..6).map(|n| Turns::nth(n, 3)).map(|t| (t.share == u32::MAX, t.frames_left)).collect();
        assert_eq!(left, [(true, 3), (false, 2), (false, 1), (true, 3), (false, 2), (false, 1)]);
    }
}
