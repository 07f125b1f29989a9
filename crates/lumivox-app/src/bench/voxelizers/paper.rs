//! The paper's numbers.

/// Output vertices of Table 1.
pub(super) const SLICING_VERTICES: [u32; 4] = [7, 11, 15, 19];
pub(super) const CLIPPING_VERTICES: [u32; 4] = [6, 9, 12, 15];

/// A line of Table 1: milliseconds of slicing and clipping for each limit, and cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    model: &'static str,
    side: u32,
    pub(super) slicing: [f64; 4],
    pub(super) clipping: [f64; 4],
    pub(super) cells: Option<f64>,
}

const LIMITS: [Limits; 8] = [
    Limits {
        model: "Bunny",
        side: 64,
        slicing: [1.74, 1.79, 2.03, 2.51],
        clipping: [1.13, 1.15, 1.28, 1.58],
        cells: Some(5.3e3),
    },
    Limits {
        model: "Bunny",
        side: 128,
        slicing: [2.37, 2.38, 2.66, 3.19],
        clipping: [1.71, 1.72, 1.86, 2.16],
        cells: Some(22e3),
    },
    Limits {
        model: "Bunny",
        side: 256,
        slicing: [5.92, 5.97, 6.43, 6.98],
        clipping: [4.92, 4.98, 5.12, 5.48],
        cells: Some(89.6e3),
    },
    Limits {
        model: "Bunny",
        side: 512,
        slicing: [28.2, 28.6, 29.3, 30.1],
        clipping: [26.9, 27.3, 27.5, 27.8],
        cells: None,
    },
    Limits {
        model: "Dragon",
        side: 64,
        slicing: [69.1, 70.6, 71.3, 72.0],
        clipping: [70.0, 71.2, 74.1, 74.9],
        cells: Some(5.4e3),
    },
    Limits {
        model: "Dragon",
        side: 128,
        slicing: [75.4, 75.8, 76.0, 76.3],
        clipping: [75.1, 75.4, 75.8, 76.2],
        cells: Some(22.5e3),
    },
    Limits {
        model: "Dragon",
        side: 256,
        slicing: [77.1, 77.5, 77.8, 78.3],
        clipping: [76.9, 77.3, 77.6, 78.0],
        cells: Some(93e3),
    },
    Limits {
        model: "Dragon",
        side: 512,
        slicing: [88.1, 88.7, 89.4, 90.3],
        clipping: [88.3, 89.1, 89.6, 90.4],
        cells: None,
    },
];

/// Table 1's line for a model on a grid.
pub(super) fn limits(model: &str, side: u32) -> Option<&'static Limits> {
    LIMITS.iter().find(|l| l.model == model && l.side == side)
}

/// Table 2, the bunny: side, slicing with 15 and clipping with 9 vertices into 1, 2 and 3 targets.
pub(super) const TARGETS: [(u32, [f64; 3], [f64; 3]); 3] = [
    (64, [2.36, 2.54, 2.70], [1.33, 1.33, 1.52]),
    (128, [3.22, 4.12, 5.18], [2.90, 2.90, 3.96]),
    (256, [10.2, 17.4, 25.1], [15.8, 15.9, 24.3]),
];

/// Table 3: model, side, milliseconds and cells of Fang and Chen's method, and of Eisemann and Decoret's.
type Approach = (&'static str, u32, (Option<f64>, Option<f64>), (f64, Option<f64>));
const APPROACHES: [Approach; 8] = [
    ("Bunny", 64, (Some(20.3), Some(5.5e3)), (0.171, Some(2.1e3))),
    ("Bunny", 128, (Some(40.8), Some(22.2e3)), (0.174, Some(18.6e3))),
    ("Bunny", 256, (Some(83.5), Some(90.3e3)), (0.21, Some(145.4e3))),
    ("Bunny", 512, (Some(181.0), None), (0.61, Some(1124e3))),
    ("Dragon", 64, (Some(3206.0), Some(5.7e3)), (35.1, Some(1.5e3))),
    ("Dragon", 128, (Some(7710.0), Some(23.2e3)), (35.3, Some(11.2e3))),
    ("Dragon", 256, (None, Some(94.5e3)), (36.5, Some(91.9e3))),
    ("Dragon", 512, (None, None), (38.8, Some(739.6e3))),
];

/// Table 3's line for a model on a grid.
pub(super) fn approaches(model: &str, side: u32) -> Option<&'static Approach> {
    APPROACHES.iter().find(|a| a.0 == model && a.1 == side)
}

/// Table 4, the bunny at 128: slicing with 15 vertices, clipping with 9.
pub(super) const DEVICES: [(&str, f64, f64); 3] =
    [("G 105M", 51.2, 30.8), ("GTS 9800M", 13.5, 6.33), ("GTX 285", 2.66, 1.72)];

/// Table 5, the bunny, slicing with 15 vertices: side, half floats, floats.
pub(super) const FORMATS: [(u32, f64, f64); 3] = [(64, 2.03, 2.04), (128, 2.66, 2.80), (256, 6.43, 7.25)];

/// Figure 7, the bunny at 256: output vertices and cells of clipping.
pub(super) const HOLES: [(u32, f64); 4] = [(3, 52_382.0), (6, 87_690.0), (9, 89_696.0), (12, 89_696.0)];
