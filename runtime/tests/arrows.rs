//! `simulate --animate --arrows` and `--mark-events`: forces at the points where they act, against closed forms.
#![cfg(all(feature = "cli", feature = "png"))]

use serde_json::Value;
use std::path::PathBuf;

/// What holds the end of a bar at a post.
const BY_CONSTRAINT: &str = "constraints: {pin: end - post}";
const BY_JOINT: &str = "joints: {pin: {hinge: [bar, ground], at: [end, post]}}";

/// A bar of 1 m and 1 kg that hangs from a pin; in `swing` it is let go from the horizontal.
fn bar(held: &str) -> String {
    format!(
        "name: Bar
parameters: {{m: 1 kg, l: 1 m, g: 10 m/s^2}}
coordinates: {{x: m, y: m, phi: rad}}
bodies: {{bar: {{mass: m, inertia: m*l^2/12, angle: phi, position: '[x, y]'}}}}
points: {{post: [0, 0], end: position(bar) - l/2*bar.x, tip: position(bar) + l/2*bar.x}}
gravity: [0, -g]
{held}
draw: [{{line: [end, tip]}}]
scene: {{start: {{phi: -pi/2}}, until: 1}}
scenes: {{swing: {{start: {{phi: 0}}, until: 1, tolerance: 1e-11}}}}
"
    )
}

struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).unwrap();
    }
}

impl Folder {
    fn new(name: &str) -> Folder {
        let folder = std::env::temp_dir().join(format!("dalembert-arrows-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Folder(folder)
    }

    fn file(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    /// Runs a model with an animation, as HTML, and options.
    fn page(&self, model: &str, options: &[&str]) -> Result<Page, String> {
        let (path, page) = (self.file("model.yaml"), self.file("page.html"));
        std::fs::write(&path, model).unwrap();
        told(&path, &[&["--animate", &page], options].concat())?;
        let text = std::fs::read_to_string(page).unwrap();
        let data = text.split("application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
        Ok(Page { data: serde_json::from_str(data).unwrap(), text })
    }
}

fn told(path: &str, options: &[&str]) -> Result<String, String> {
    let arguments = [&["dalembert", "simulate", path, "--no-digits"], options].concat();
    let mut out = Vec::new();
    match dalembert::cli::run(&[], arguments, &mut out) {
        Ok(()) => Ok(String::from_utf8(out).unwrap()),
        Err(problem) => Err(problem.to_string()),
    }
}

fn library(model: &str) -> String {
    std::fs::read_to_string(format!("{}/../models/{model}.yaml", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

struct Page {
    data: Value,
    text: String,
}

impl Page {
    fn names(&self) -> Vec<&str> {
        self.data["arrows"]["names"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect()
    }

    /// The frame that is nearest to a time: its own time, and where an arrow begins and its force, N; `None` where there is no arrow.
    fn force(&self, name: &str, t: f64) -> (f64, Option<[[f64; 2]; 2]>) {
        let place = self.names().iter().position(|known| *known == name).unwrap();
        let number =
            |value: &Value, unit: &str| value.as_f64().map_or(f64::NAN, |k| k * self.data[unit].as_f64().unwrap());
        let times: Vec<f64> = self.data["time"].as_array().unwrap().iter().map(|k| number(k, "tick")).collect();
        let nearest = (0..times.len()).min_by(|a, b| (times[*a] - t).abs().total_cmp(&(times[*b] - t).abs())).unwrap();
        let mut frame: Vec<f64> = self.data["first"].as_array().unwrap().iter().map(|x| number(x, "unit")).collect();
        for (k, place) in self.data["moving"].as_array().unwrap().iter().enumerate() {
            frame[place.as_u64().unwrap() as usize] = number(&self.data["frames"][nearest][k], "unit");
        }
        let first = frame.len() - 4 * (self.names().len() - place);
        let [x, y, u, v] = [0, 1, 2, 3].map(|k| frame[first + k]);
        let scale = &self.data["arrows"];
        let value: f64 = scale["text"].as_str().unwrap().split(' ').next().unwrap().parse().unwrap();
        let newtons = value / scale["length"].as_f64().unwrap();
        let there = [x, y, u, v].iter().all(|x| x.is_finite());
        (times[nearest], there.then_some([[x, y], [(u - x) * newtons, (v - y) * newtons]]))
    }
}

fn near(found: [f64; 2], wanted: [f64; 2], within: f64) {
    let off = (found[0] - wanted[0]).hypot(found[1] - wanted[1]);
    assert!(off < within, "{found:?}, not {wanted:?}");
}

#[test]
fn at_rest_the_pin_bears_the_weight() {
    for (name, held) in [("constraint", BY_CONSTRAINT), ("joint", BY_JOINT)] {
        let page = Folder::new(name).page(&bar(held), &["--arrows"]).unwrap();
        assert_eq!(page.names(), ["pin"]);
        assert_eq!(page.data["arrows"]["text"], "10 N");
        let [at, force] = page.force("pin", 0.5).1.unwrap();
        near(at, [0.0, 0.0], 1e-5);
        near(force, [0.0, 10.0], 1e-3);
    }
}

/// Of a bar that is let go from the horizontal, turned down by θ: m a of its middle is l/2 (ω² towards the pin, ω' across), with ω² = 3 g/l sin θ
/// and ω' = 3/2 g/l cos θ.
#[test]
fn a_bar_that_swings_pulls_as_its_acceleration_says() {
    let (m, l, g) = (1.0, 1.0, 10.0);
    let folder = Folder::new("swing");
    for held in [BY_CONSTRAINT, BY_JOINT] {
        let page = folder.page(&bar(held), &["--scene", "swing", "--arrows", "pin"]).unwrap();
        for t in [0.1, 0.3, 0.5, 0.8] {
            let (time, arrow) = page.force("pin", t);
            let theta = turned(time, g / l);
            let (s, c) = theta.sin_cos();
            let inwards = m * l / 2.0 * 3.0 * g / l * s;
            let across = m * l / 2.0 * 1.5 * g / l * c;
            let force = [-inwards * c - across * s, inwards * s - across * c + m * g];
            let [at, found] = arrow.unwrap();
            near(at, [0.0, 0.0], 1e-5);
            near(found, force, 2e-3);
        }
    }
}

/// θ of θ'' = 3/2 g/l cos θ from rest at 0, by classical Runge-Kutta.
fn turned(t: f64, ratio: f64) -> f64 {
    let (count, mut state) = (4000, [0.0_f64, 0.0]);
    let h = t / f64::from(count);
    let rate = |[angle, speed]: [f64; 2]| [speed, 1.5 * ratio * angle.cos()];
    let along = |s: [f64; 2], k: [f64; 2], h: f64| [s[0] + h * k[0], s[1] + h * k[1]];
    for _ in 0..count {
        let a = rate(state);
        let b = rate(along(state, a, h / 2.0));
        let c = rate(along(state, b, h / 2.0));
        let d = rate(along(state, c, h));
        state = std::array::from_fn(|k| state[k] + h / 6.0 * (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]));
    }
    state[0]
}

/// The rod of a pendulum in x and y pulls its bob along the rod, whether a constraint or a reaction of the balances says so.
#[test]
fn constraints_in_coordinates_and_named_reactions_act_at_their_body() {
    let page = Folder::new("cartesian").page(&library("pendulum_cartesian"), &["--arrows", "--until", "1"]).unwrap();
    assert_eq!(page.names(), ["rod", "pull"]);
    for t in [0.3, 0.7] {
        let [[rod, force], [pull, same]] = ["rod", "pull"].map(|name| page.force(name, t).1.unwrap());
        // From the horizontal at rest: v² = 2 g d at the depth d below the pin, and the pull is m v²/l + m g d/l.
        let depth = -rod[1];
        near(force, [-30.0 * depth * rod[0], -30.0 * depth * rod[1]], 5e-3);
        near(rod, pull, 1e-5);
        near(force, same, 5e-3);
    }
}

/// `normal` is a reaction of three systems, one for each phase, and the floor is a constraint in all of them.
#[test]
fn a_reaction_of_several_systems_is_drawn_once() {
    let page = Folder::new("several").page(&library("stick_slip"), &["--arrows", "normal,floor"]).unwrap();
    assert_eq!(page.names(), ["floor", "normal"]);
    let [[_, floor], [_, normal]] = ["floor", "normal"].map(|name| page.force(name, 1.0).1.unwrap());
    near(floor, normal, 1e-3);
}

#[test]
fn a_ball_in_flight_has_no_arrow_and_on_the_floor_its_weight() {
    let folder = Folder::new("ball");
    let page = folder.page(&library("bouncing_ball"), &["--arrows", "normal,floor", "--mark-events"]).unwrap();
    assert_eq!(page.data["arrows"]["text"], "5 N");
    for name in ["normal", "floor"] {
        assert!(page.force(name, 0.3).1.is_none());
        near(page.force(name, 2.5).1.unwrap()[1], [0.0, 9.81], 1e-3);
    }
    let events = page.data["events"].as_array().unwrap();
    // It falls 1 m.
    assert!((events[0][0].as_f64().unwrap() - (2.0_f64 / 9.81).sqrt()).abs() < 1e-9);
    assert_eq!(events[0][1], "bounce");
}

/// A load that pushes at a point, and a spring between two bodies with its forces at both ends.
#[test]
fn loads_and_springs_act_where_they_say() {
    let text = "name: Pair
parameters: {m: 1 kg, k: 8 N/m, w: 1 rad/s, F: 4 N}
coordinates: {p: m, q: m}
bodies: {a: {mass: m, position: '[p, 0]'}, b: {mass: m, position: '[q, 0]'}}
springs: {s: {between: [a, b], stiffness: k, rest: 1 m}}
forces: {pull: {on: b, force: '[F*sin(w*t), 0]'}}
draw: [{line: [a, b]}]
scene: {start: {p: 0, q: 1.5 m}, until: 1}
";
    let page = Folder::new("loads").page(text, &["--arrows"]).unwrap();
    assert_eq!(page.names(), ["s", "s", "pull"]);
    let [at, force] = page.force("s", 0.0).1.unwrap();
    near(at, [0.0, 0.0], 1e-5);
    near(force, [4.0, 0.0], 1e-3);
    assert!(page.force("pull", 0.0).1.is_none());
    let (t, arrow) = page.force("pull", 0.5);
    near(arrow.unwrap()[1], [4.0 * t.sin(), 0.0], 1e-3);
}

#[test]
fn names_are_refused_with_what_may_be_meant() {
    let folder = Folder::new("names");
    let refused = |model: &str, options: &[&str]| folder.page(model, options).err().unwrap();
    let bar = bar(BY_JOINT);
    let problem = refused(&bar, &["--arrows", "pni"]);
    assert_eq!(problem, "error: no force is called `pni`; did you mean `pin`?");
    let problem = refused(&bar, &["--mark-events"]);
    assert_eq!(problem, "error: --mark-events: model has no events");
    let problem = refused(&library("bouncing_ball"), &["--mark-events", "bonce"]);
    assert_eq!(problem, "error: no event is called `bonce`; did you mean `bounce`?");
    let problem = refused(&library("gear_box"), &["--arrows", "teeth"]);
    assert!(
        problem.starts_with("error: --arrows: the file does not say at which point `teeth` acts as a force"),
        "{problem}"
    );
    let free = "{name: Falls, parameters: {m: 1 kg}, coordinates: {x: m}, bodies: {b: {mass: m, position: '[x, 0]'}}, \
                draw: [{trace: b}], scene: {until: 1}}";
    let problem = refused(free, &["--arrows"]);
    assert!(problem.starts_with("error: --arrows: model has no force to draw: it has no constraints"), "{problem}");
    let path = folder.file("model.yaml");
    assert!(told(&path, &["--arrows"]).unwrap_err().contains("--animate"));
}

/// What is added to a page is small, and nothing is where it is not asked for.
#[test]
fn a_page_without_arrows_is_what_it_was() {
    let folder = Folder::new("without");
    let (bare, with) = (folder.page(&bar(BY_JOINT), &[]).unwrap(), folder.page(&bar(BY_JOINT), &["--arrows"]).unwrap());
    assert!(bare.data["arrows"].is_null() && bare.data["events"].is_null());
    assert!(!bare.text.contains("drawOver") && with.text.contains("drawOver"));
    let script = |page: &Page| page.text.split("<script>").nth(1).unwrap().to_owned();
    assert!(script(&with).starts_with(script(&bare).strip_suffix("</script>\n</html>\n").unwrap()));
    let own = with.text.len() - with.data.to_string().len();
    assert!(own < 40_000, "{own} bytes");
    for outside in ["http:", "https:", "src=", "href=", "url(", "import", "fetch("] {
        assert!(!with.text.contains(outside), "{outside}");
    }
}

#[test]
fn pictures_have_arrows_their_scale_and_events() {
    let folder = Folder::new("pictures");
    let path = folder.file("ball.yaml");
    std::fs::write(&path, library("bouncing_ball")).unwrap();
    let svg = |options: &[&str]| {
        let picture = folder.file("picture.svg");
        told(
            &path,
            &[&["--animate", &picture, "--state", &folder.file("end.yaml"), "--until", "3.5"], options].concat(),
        )
        .unwrap();
        std::fs::read_to_string(picture).unwrap()
    };
    told(&path, &["--save", &folder.file("end.yaml")]).unwrap();
    let (bare, with) = (svg(&[]), svg(&["--arrows", "normal"]));
    assert!(!bare.contains("normal") && with.contains("normal") && with.contains("5 N"));
    assert_eq!(svg(&[]), bare);
    assert!(!bare.contains(">\n\n</text>"), "an empty text");
    for name in ["film.gif", "film.png"] {
        let [bare, with] = [&[][..], &["--arrows", "--mark-events"][..]].map(|options| {
            told(&path, &[&["--animate", &folder.file(name), "--until", "1"], options].concat()).unwrap();
            std::fs::read(folder.file(name)).unwrap()
        });
        assert_ne!(bare, with);
    }
}
