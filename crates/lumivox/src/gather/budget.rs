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
/// A frame that took too long is answered at once. Back it goes as far as the last 32 frames allow: by the second longest of them, so
/// that about one frame in twenty is over what is aimed at, a tenth below the budget, however unsteady the machine is. What a frame takes
/// whoever's turn it is, the controller finds by itself ([`fixed_ms`](Self::fixed_ms)) and counts: shadow views, making surfels where
/// something has moved, and four short passes over all of them. A budget below that cannot hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBudget {
    budget_ms: f64,
    frames: f64,
    fixed_ms: f64,
    /// What the last frames took, and one over the frames of a round then; a ring.
    seen: [(f64, f64); WINDOW],
    count: usize,
}

/// The part of the budget that is aimed at.
const AIM: f64 = 0.9;
/// The part of the way up that is gone in a frame.
const UP: f64 = 0.2;
/// Frames of a round at most: then light is a second old, at 60 a second.
const MOST: f64 = 64.0;
/// Frames that are remembered.
const WINDOW: usize = 32;
/// The least ratio between the longest and the shortest rounds among them from which fixed costs are told apart from others.
const SPREAD: f64 = 1.3;
/// The part of the budget that is there for turns at least, whatever fixed costs seem to be.
const LEAST_ROOM: f64 = 0.1;

impl LightBudget {
    /// A budget of so many milliseconds a frame, above 0. It begins with a few surfels a frame.
    pub fn new(budget_ms: f64) -> Self {
        let budget_ms = budget_ms.max(1e-3);
        Self { budget_ms, frames: 16.0, fixed_ms: 0.0, seen: [(0.0, 0.0); WINDOW], count: 0 }
    }

    /// Takes what the last frame's light took, and returns the frames of a round from now on.
    pub fn measured(&mut self, ms: f64) -> f32 {
        if ms.is_finite() && ms > 0.0 {
            self.seen[self.count % WINDOW] = (ms, 1.0 / self.frames);
            self.count += 1;
            self.find_fixed();
            let room = (AIM * self.budget_ms - self.fixed_ms).max(LEAST_ROOM * self.budget_ms);
            let wanted = |(ms, share): (f64, f64)| (ms - self.fixed_ms).max(0.0) / share / room;
            let now = wanted((ms, 1.0 / self.frames)).clamp(0.25 * self.frames, 4.0 * self.frames);
            let usual = self.second_longest(wanted);
            let next = if now > self.frames {
                now
            } else {
                // In equal ratios: from 16 to 8 takes as long as from 8 to 4.
                let target = usual.clamp(0.25 * self.frames, self.frames);
                self.frames * (target / self.frames).powf(UP)
            };
            self.frames = next.clamp(1.0, MOST);
        }
        self.frames as f32
    }

    fn recent(&self) -> &[(f64, f64)] {
        &self.seen[..self.count.min(WINDOW)]
    }

    /// Of what frames want, all but the longest.
    fn second_longest(&self, wanted: impl Fn((f64, f64)) -> f64) -> f64 {
        let (mut first, mut second) = (0.0, 0.0);
        for found in self.recent().iter().map(|&seen| wanted(seen)) {
            if found > first {
                (first, second) = (found, first);
            } else if found > second {
                second = found;
            }
        }
        // One alone may be anything.
        if self.recent().len() < 2 { first } else { second }
    }

    /// Costs over shares are a line; where it meets a share of nothing is what does not depend on turns. Rounds that were all alike say
    /// nothing about it.
    fn find_fixed(&mut self) {
        let seen = self.recent();
        let shares = seen.iter().map(|s| s.1);
        let (least, most) = shares.fold((f64::INFINITY, 0.0), |(l, m): (f64, f64), s| (l.min(s), m.max(s)));
        if most < SPREAD * least {
            return;
        }
        let n = seen.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| seen.iter().map(of).sum::<f64>() / n;
        let (ms, share) = (mean(&|s| s.0), mean(&|s| s.1));
        let slope = mean(&|s| (s.0 - ms) * (s.1 - share)) / mean(&|s| (s.1 - share).powi(2));
        let shortest = seen.iter().map(|s| s.0).fold(f64::INFINITY, f64::min);
        self.fixed_ms = (ms - slope.max(0.0) * share).clamp(0.0, 0.9 * shortest);
    }

    /// What a frame takes whoever's turn it is, milliseconds, as far as rounds of different length have told.
    pub fn fixed_ms(&self) -> f64 {
        self.fixed_ms
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

    /// A busy machine: a frame takes half as long again or two thirds, by chance, and one in forty three times as long.
    #[test]
    fn a_budget_holds_on_a_busy_machine() {
        for (fixed, load) in [(0.1, 10.0), (0.6, 10.0), (0.3, 60.0)] {
            let mut budget = LightBudget::new(2.0);
            let (mut frames, mut state) = (f64::from(budget.frames()), 7u64);
            let mut unit = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 33) as f64 / f64::from(1u32 << 31)
            };
            let costs: Vec<f64> = (0..1000)
                .map(|_| {
                    let busy = (2.0 * (unit() - 0.5) * 1.5f64.ln()).exp();
                    let spike = if unit() < 1.0 / 40.0 { 3.0 } else { 1.0 };
                    let ms = spike * busy * (fixed + load / frames);
                    frames = f64::from(budget.measured(ms));
                    ms
                })
                .collect();
            let settled = &costs[100..];
            let (middle, high) = (percentile(settled, 0.5), percentile(settled, 0.95));
            println!("fixed {fixed}, load {load}: middle {middle}, 95th {high}, {} found", budget.fixed_ms());
            assert!(high < 2.0 && middle > 0.9, "fixed {fixed}, load {load}: middle {middle}, 95th {high}");
        }
    }

    #[test]
    fn fixed_costs_are_told_apart() {
        let mut budget = LightBudget::new(2.0);
        (0..40).for_each(|n| {
            _ = budget.measured(0.7 + (if n < 8 { 5.0 } else { 12.0 }) / f64::from(budget.frames()))
        });
        assert_eq!(LightBudget::new(1.0).fixed_ms(), 0.0);
        let found = budget.fixed_ms();
        assert!((found - 0.7).abs() < 0.2, "{found}");
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
