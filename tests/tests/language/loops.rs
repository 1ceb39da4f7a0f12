//! Random closed loops of three to six pinned bars, by three files: an angle for every bar and one pin that closes the loop;
//! three coordinates for every bar and a pin at every joint; and as few angles as there are freedoms, the last two bars a
//! dyad whose joint is where two circles meet, each of them three grains (a sixth, two thirds and a sixth of its mass).

use dalembert::{Error, Run};
use dalembert_tests::case::Case;
use dalembert_tests::random_runs::Draws;

struct Loop {
    lengths: Vec<f64>,
    masses: Vec<f64>,
    /// From the horizontal; of the dyad where it begins.
    angles: Vec<f64>,
    /// Of all bars but the dyad.
    rates: Vec<f64>,
    /// Where the last bar is pinned to the ground.
    end: [f64; 2],
    /// On which side the dyad's joint is.
    side: f64,
    gravity: f64,
    damping: f64,
}

fn draw(run: u64) -> Loop {
    let mut draws = Draws::new(run);
    let bars = *draws.pick(&[3, 4, 5, 6]);
    let mut many =
        |count: usize, low: f64, high: f64| (0..count).map(|_| draws.between(low, high)).collect::<Vec<f64>>();
    let (chain, dyad) = (many(bars - 2, 0.4, 1.2), many(2, 0.7, 1.4));
    let (mut angles, rates) = (many(bars - 2, -2.0, 2.0), many(bars - 2, -1.0, 1.0));
    let (apart, towards) = (many(1, 0.5, 0.8)[0] * (dyad[0] + dyad[1]), many(1, -3.0, 3.0)[0]);
    let apart = apart.max(1.3 * (dyad[0] - dyad[1]).abs());
    let along = |from: [f64; 2], l: f64, angle: f64| [from[0] + l * angle.cos(), from[1] + l * angle.sin()];
    let last = chain.iter().zip(&angles).fold([0.0; 2], |from, (l, angle)| along(from, *l, *angle));
    let end = along(last, apart, towards);
    let side = draws.sign();
    // The law of cosines.
    let inner = ((dyad[0].powi(2) + apart.powi(2) - dyad[1].powi(2)) / (2.0 * dyad[0] * apart)).acos();
    let joint = along(last, dyad[0], towards + side * inner);
    angles.extend([towards + side * inner, (end[1] - joint[1]).atan2(end[0] - joint[0])]);
    Loop {
        masses: (0..bars).map(|_| draws.scale(0.3, 3.0)).collect(),
        lengths: [chain, dyad].concat(),
        angles,
        rates,
        end,
        side,
        gravity: *draws.pick(&[0.0, 9.81]),
        damping: *draws.pick(&[0.0, 0.2]),
    }
}

impl Loop {
    fn bars(&self) -> usize {
        self.lengths.len()
    }

    fn each(&self, separator: &str, word: impl Fn(usize) -> String) -> String {
        (1..=self.bars()).map(word).collect::<Vec<_>>().join(separator)
    }

    /// One file: its coordinates, what is said of points, bodies and constraints, and what it begins near.
    fn file(&self, coordinates: &[String], geometry: &str, guess: &str, until: f64) -> String {
        let free = self.bars() - 2;
        let start: Vec<String> =
            (0..free).map(|k| format!("a{}: {:e}, a{}': {:e}", k + 1, self.angles[k], k + 1, self.rates[k])).collect();
        format!(
            "name: Loop
parameters: {{g: {:e} m/s^2, c: {:e} N*s/m, dx: {:e} m, dy: {:e} m, {}}}
coordinates: {{{}}}
{geometry}gravity: [0, -g]
dampers: {{d: {{between: [ground, b1], damping: c}}}}
outputs: {{{}}}
scene: {{start: {{{}}}, {guess}until: {until:e}, tolerance: 1e-10}}
",
            self.gravity,
            self.damping,
            self.end[0],
            self.end[1],
            self.each(", ", |k| format!("l{k}: {:e} m, m{k}: {:e} kg", self.lengths[k - 1], self.masses[k - 1])),
            coordinates.join(", "),
            self.each(", ", |k| format!("b{k}: position(b{k})")),
            start.join(", "),
        )
    }

    fn chain(to: usize) -> String {
        let points = (1..=to).map(|k| format!("  p{k}: p{} + l{k}*[cos(a{k}), sin(a{k})]\n", k - 1));
        format!("points:\n  p0: [0, 0]\n  D: [dx, dy]\n{}", points.collect::<String>())
    }

    fn bar(k: usize) -> String {
        format!("  b{k}: {{mass: m{k}, inertia: m{k}*l{k}^2/12, angle: a{k}, position: (p{} + p{k})/2}}\n", k - 1)
    }

    /// An angle for every bar, and one pin.
    fn by_one_pin(&self, until: f64) -> String {
        let n = self.bars();
        let coordinates: Vec<String> = (1..=n).map(|k| format!("a{k}: rad")).collect();
        let bodies: String = (1..=n).map(Self::bar).collect();
        let geometry = format!("{}bodies:\n{bodies}constraints: {{pin: p{n} - D}}\n", Self::chain(n));
        let guess = format!("guess: {{a{}: {:.4}, a{n}: {:.4}}}, ", n - 1, self.angles[n - 2], self.angles[n - 1]);
        self.file(&coordinates, &geometry, &guess, until)
    }

    /// Three coordinates for every bar, and all pins.
    fn by_all_pins(&self, until: f64) -> String {
        let n = self.bars();
        let coordinates: Vec<String> = (1..=n).map(|k| format!("x{k}: m, y{k}: m, a{k}: rad")).collect();
        let points = self.each("", |k| format!("  s{k}: b{k} - l{k}/2*b{k}.x\n  e{k}: b{k} + l{k}/2*b{k}.x\n"));
        let bodies = self.each("", |k| {
            format!("  b{k}: {{mass: m{k}, inertia: m{k}*l{k}^2/12, angle: a{k}, position: \"[x{k}, y{k}]\"}}\n")
        });
        let pins: String = (1..n).map(|k| format!("pin{k}: e{k} - s{}, ", k + 1)).collect();
        let geometry = format!(
            "points:\n  D: [dx, dy]\n{points}bodies:\n{bodies}constraints: {{begin: s1, {pins}end: e{n} - D}}\n"
        );
        let mut from = [0.0, 0.0];
        let mut guess = Vec::new();
        for (k, (l, angle)) in self.lengths.iter().zip(&self.angles).enumerate() {
            let [x, y] = [from[0] + l * angle.cos(), from[1] + l * angle.sin()];
            guess.push(format!("x{}: {:.4}, y{}: {:.4}", k + 1, (from[0] + x) / 2.0, k + 1, (from[1] + y) / 2.0));
            if k + 2 >= n {
                guess.push(format!("a{}: {angle:.4}", k + 1));
            }
            from = [x, y];
        }
        self.file(&coordinates, &geometry, &format!("guess: {{{}}}, ", guess.join(", ")), until)
    }

    /// As few angles as freedoms.
    fn by_freedoms(&self, until: f64) -> String {
        let n = self.bars();
        let coordinates: Vec<String> = (1..=n - 2).map(|k| format!("a{k}: rad")).collect();
        let tip = format!("p{}", n - 2);
        let grains = |k: usize, from: &str, to: &str| {
            format!(
                "  i{k}: {{mass: m{k}/6, position: {from}}}\n  b{k}: {{mass: 2/3*m{k}, position: ({from} + {to})/2}}
  o{k}: {{mass: m{k}/6, position: {to}}}\n"
            )
        };
        let bodies: String = (1..=n - 2).map(Self::bar).collect();
        let geometry = format!(
            "define:
  apart: dot(D - {tip}, D - {tip})
  along: (l{}^2 - l{n}^2 + apart)/(2*apart)
  aside: {}*sqrt(l{}^2/apart - along^2)
{}  J: {tip} + along*(D - {tip}) + aside*cross(1, D - {tip})
bodies:
{bodies}{}{}",
            n - 1,
            self.side,
            n - 1,
            Self::chain(n - 2),
            grains(n - 1, &tip, "J"),
            grains(n, "J", "D"),
        );
        self.file(&coordinates, &geometry, "", until)
    }

    /// The largest difference of the bars' middles at the ends of two runs.
    fn apart(&self, one: &Run, other: &Run) -> f64 {
        let (one, other) = (one.last(), other.last());
        assert!((one.t - other.t).abs() < 1e-12, "{} {}", one.t, other.t);
        let names = (1..=self.bars()).flat_map(|k| ["x", "y"].map(|axis| format!("b{k}.{axis}")));
        names.map(|name| (one[name.as_str()] - other[name.as_str()]).abs()).fold(0.0, f64::max)
    }
}

#[test]
fn closed_loops_of_bars_move_alike_however_they_are_written() {
    let mut to_the_end = 0;
    for run in 0..RUNS {
        let drawn = draw(run);
        // The twin knows no stretched dyad: where one comes, its run ends, and all are compared before.
        let (until, twin) = match Case::written(&drawn.by_freedoms(1.0)).try_run() {
            Ok(twin) => (1.0, twin),
            Err(Error::Run(failure)) => {
                let until = 0.8 * failure.state.t;
                (until, Case::written(&drawn.by_freedoms(until)).run())
            }
            Err(error) => panic!("{error}"),
        };
        to_the_end += usize::from(until == 1.0);
        for text in [drawn.by_one_pin(until), drawn.by_all_pins(until)] {
            let found = Case::written(&text).run();
            let (off, residuals) = (drawn.apart(&found, &twin), found.residuals.expect("constraints"));
            assert!(off < 1e-7, "run {run}, {} bars: off by {off:e}\n{text}", drawn.bars());
            assert!(residuals.position < 1e-12 && residuals.velocity < 1e-11, "run {run}: {residuals:?}\n{text}");
        }
        // Past what the twin cannot do, both others go on together.
        let [one, all] = [drawn.by_one_pin(1.0), drawn.by_all_pins(1.0)].map(|text| Case::written(&text).run());
        let off = drawn.apart(&one, &all);
        assert!(off < 1e-6, "run {run}, {} bars: off by {off:e}\n{}", drawn.bars(), drawn.by_one_pin(1.0));
        for drift in [&one, &all].map(|run| run.energy_balance) {
            assert!(drift.is_some_and(|drift| drift < 1e-8), "run {run}: {drift:?}");
        }
    }
    assert!(to_the_end >= 2, "{to_the_end}");
}

/// A larger form is run by hand.
const RUNS: u64 = 5;
