//! Line plots over logarithmic axes, as SVG.

use std::fmt::Write;

const WIDTH: f64 = 740.0;
const HEIGHT: f64 = 440.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 210.0;
const TOP: f64 = 44.0;
const BOTTOM: f64 = 56.0;
/// Told apart in grey and by those who do not see all colours.
const COLORS: [&str; 8] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#b07800", "#444444", "#999999"];

/// A line with its name.
#[derive(Clone, Debug)]
pub(super) struct Series {
    pub(super) name: String,
    /// Positive numbers.
    pub(super) points: Vec<(f64, f64)>,
}

#[derive(Clone, Debug)]
pub(super) struct Plot {
    pub(super) title: String,
    pub(super) x: &'static str,
    pub(super) y: &'static str,
    pub(super) series: Vec<Series>,
}

/// A logarithmic axis from `low` to `high`, drawn from `from` to `to`.
#[derive(Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn new(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let logs = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let space = (0.04 * (high - low)).max(0.05);
        Self { low: low - space, high: high + space, from, to }
    }

    fn at(&self, value: f64) -> f64 {
        self.from + (value.log10() - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Powers of ten, with twos and fives where there are few.
    fn ticks(&self) -> Vec<f64> {
        let steps: &[f64] = if self.high - self.low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        let all = decades.flat_map(|d| steps.iter().map(move |s| s * 10f64.powi(d)));
        all.filter(|t| (self.low..=self.high).contains(&t.log10())).collect()
    }
}

/// A tick's number: 5, 200, 10K, 2M, 0.1.
fn label(value: f64) -> String {
    match value {
        v if v >= 1e6 => format!("{}M", v / 1e6),
        v if v >= 1e4 => format!("{}K", v / 1e3),
        v => format!("{}", (v * 1e6).round() / 1e6),
    }
}

impl Plot {
    pub(super) fn svg(&self) -> String {
        let points = || self.series.iter().flat_map(|s| s.points.iter().copied());
        let x = Axis::new(points().map(|p| p.0), LEFT, WIDTH - RIGHT);
        let y = Axis::new(points().map(|p| p.1), HEIGHT - BOTTOM, TOP);
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"12\">\n\
             <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#ffffff\"/>\n\
             <text x=\"{LEFT}\" y=\"24\" font-size=\"15\">{}</text>\n",
            escaped(&self.title)
        );
        for tick in x.ticks() {
            let (at, top, bottom) = (x.at(tick), TOP, HEIGHT - BOTTOM);
            let _ = writeln!(
                out,
                "<path d=\"M{at:.1} {top}V{bottom}\" stroke=\"#dddddd\"/><text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                bottom + 18.0,
                label(tick)
            );
        }
        for tick in y.ticks() {
            let (at, right) = (y.at(tick), WIDTH - RIGHT);
            let _ = writeln!(
                out,
                "<path d=\"M{LEFT} {at:.1}H{right}\" stroke=\"#dddddd\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                LEFT - 6.0,
                at + 4.0,
                label(tick)
            );
        }
        let middle = (TOP + HEIGHT - BOTTOM) / 2.0;
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text><text transform=\"translate(18 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            (LEFT + WIDTH - RIGHT) / 2.0,
            HEIGHT - 14.0,
            escaped(self.x),
            escaped(self.y)
        );
        for (n, series) in self.series.iter().enumerate() {
            let color = COLORS[n % COLORS.len()];
            let places: Vec<_> = series.points.iter().map(|p| (x.at(p.0), y.at(p.1))).collect();
            let line: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
            let _ = writeln!(
                out,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>",
                line.join(" ")
            );
            for (x, y) in places {
                let _ = writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{color}\"/>");
            }
            let (left, at) = (WIDTH - RIGHT + 14.0, TOP + 10.0 + 20.0 * n as f64);
            let _ = writeln!(
                out,
                "<path d=\"M{left} {at}h20\" stroke=\"{color}\" stroke-width=\"2\"/><text x=\"{}\" y=\"{}\">{}</text>",
                left + 26.0,
                at + 4.0,
                escaped(&series.name)
            );
        }
        out + "</svg>\n"
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_on_their_ticks_and_text_is_escaped() {
        let series = Series { name: "a < b".to_owned(), points: vec![(10.0, 1.0), (1000.0, 100.0)] };
        let plot = Plot { title: "T & U".to_owned(), x: "x", y: "ms", series: vec![series] };
        let svg = plot.svg();
        assert!(svg.contains("T &amp; U") && svg.contains("a &lt; b"));
        let axis = Axis::new([10.0, 1000.0].into_iter(), LEFT, WIDTH - RIGHT);
        assert!(svg.contains(&format!("<circle cx=\"{:.1}\"", axis.at(10.0))));
        assert!(axis.at(100.0) > axis.at(10.0) && axis.ticks().contains(&100.0));
        // The middle of a logarithmic axis is the geometric mean.
        assert!((2.0 * axis.at(100.0) - axis.at(10.0) - axis.at(1000.0)).abs() < 1e-9);
    }

    #[test]
    fn nothing_to_plot_is_an_empty_plot() {
        let plot = Plot { title: String::new(), x: "x", y: "y", series: Vec::new() };
        assert!(plot.svg().ends_with("</svg>\n") && !plot.svg().contains("NaN"));
    }
}
