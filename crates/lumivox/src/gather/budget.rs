//! As much light in a frame as there is time for.

/// Finds the [`GatherSettings::frames`](super::GatherSettings::frames) with which gathering takes the time that a frame has for it.
///
/// The host measures what the stages from `record_dark` and `record_surfels` to `record_bounces` took, by time stamps or otherwise, and tells; the number
/// that comes back holds from the next [`begin_frame`](super::GatheredLight::begin_frame) on:
///
/// ```
/// let mut budget = lumivox::gather::LightBudget::new(2.0);
/// // Each frame:
/// let measured_ms = 3.1;
/// let frames = budget.measured(measured_ms);
/// // light.set_frames(frames);
/// # assert!(frames > 1.0);
/// ```
///
/// It goes down at once when a frame took too long and up slowly, and aims a tenth below the budget, so that ordinary noise stays
/// within. It cannot go below what does not depend on turns: shadow views, making surfels where something has moved, and four short passes over all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBudget {
    budget_ms: f64,
    frames: f64,
}

/// The part of the budget that is aimed at.
const AIM: f64 = 0.9;
/// The part of the way up that is gone in a frame.
const UP: f64 = 0.1;
/// Frames of a round at most: then light is a second old, at 60 a second.
const MOST: f64 = 64.0;

impl LightBudget {
    /// A budget of so many milliseconds a frame, above 0. It begins with a few surfels a frame.
    pub fn new(budget_ms: f64) -> Self {
        Self { budget_ms: budget_ms.max(1e-3), frames: 16.0 }
    }

    /// Takes what the last frame's light took, and returns the frames of a round from now on.
    pub fn measured(&mut self, ms: f64) -> f32 {
        if ms.is_finite() && ms > 0.0 {
            let wanted = self.frames * (ms / (AIM * self.budget_ms)).clamp(0.25, 4.0);
            let slower = wanted > self.frames;
            // In equal ratios: from 16 to 8 takes as long as from 8 to 4.
            let next = if slower { wanted } else { self.frames * (wanted / self.frames).powf(UP) };
            self.frames = next.clamp(1.0, MOST);
        }
        self.frames as f32
    }

    /// Whether a frame that took so long is more than the budget though rounds are as long as they get.
    pub fn is_exhausted(&self, ms: f64) -> bool {
        self.frames >= MOST && ms > self.budget_ms
    }

    /// The frames of a round.
    pub fn frames(&self) -> f32 {
        self.frames as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Costs of 300 frames of a load that a `load` of the frame's number makes, with noise of a twentieth.
    fn costs(budget_ms: f64, fixed_ms: f64, load: impl Fn(u32) -> f64) -> Vec<f64> {
        let mut budget = LightBudget::new(budget_ms);
        let mut frames = budget.frames();
        (0..300u32)
            .map(|n| {
                let noise = 1.0 + 0.1 * ((f64::from(n) * 0.618_034).fract() - 0.5);
                let ms = fixed_ms + noise * load(n) / f64::from(frames);
                frames = budget.measured(ms);
                ms
            })
            .collect()
    }

    fn percentile(costs: &[f64], part: f64) -> f64 {
        let mut sorted = costs.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted[(part * (sorted.len() - 1) as f64) as usize]
    }

    #[test]
    fn a_budget_holds_and_is_used() {
        for (fixed, load) in [(0.0, 10.0), (0.5, 10.0), (0.5, 40.0)] {
            let costs = costs(2.0, fixed, |_| load);
            let settled = &costs[100..];
            let (middle, high) = (percentile(settled, 0.5), percentile(settled, 0.95));
            assert!(high < 2.0 && middle > 1.6, "fixed {fixed}, load {load}: middle {middle}, 95th {high}");
        }
    }

    #[test]
    fn a_load_that_grows_and_jumps_is_followed() {
        let costs = costs(2.0, 0.2, |n| if n < 150 { 10.0 + 0.1 * f64::from(n) } else { 60.0 });
        assert!(percentile(&costs[50..150], 0.95) < 2.0);
        // One frame pays for the jump.
        assert!(costs[150] > 2.0 && costs[151..].iter().all(|&ms| ms < 2.4), "{:?}", &costs[148..160]);
    }

    #[test]
    fn what_cannot_hold_says_so() {
        let mut budget = LightBudget::new(1.0);
        (0..20).for_each(|_| _ = budget.measured(3.0));
        assert!(budget.is_exhausted(3.0) && !budget.is_exhausted(0.9));
        assert!(!LightBudget::new(1.0).is_exhausted(3.0));
    }

    #[test]
    fn little_work_is_done_in_every_frame() {
        let mut budget = LightBudget::new(5.0);
        (0..200).for_each(|_| _ = budget.measured(1.0 / f64::from(budget.frames())));
        assert_eq!(budget.frames(), 1.0);
        for strange in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(budget.measured(strange), 1.0);
        }
    }
}
