//! The animation in a real browser, Debian's chromium without a window.
//!
//! Where it is not installed these tests say so and pass; in CI, where the variable `CI` is set, they fail.

use dalembert::mechanism::Shape;
use dalembert::show::{Animation, Axis, Chart, Series};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What the page says of itself after its script has run for some milliseconds of the browser's own time.
fn look(directory: &Path, address: &str, milliseconds: u32) -> Option<HashMap<String, String>> {
    let profile = directory.join(format!("profile-{}", address.replace(|c: char| !c.is_alphanumeric(), "-")));
    let page = format!("file://{}/{address}", directory.display());
    let output = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .arg("--window-size=800,600")
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("--virtual-time-budget={milliseconds}"))
        .args(["--dump-dom", &page])
        .stderr(Stdio::null())
        .output();
    let output = match output {
        Ok(output) => output,
        Err(problem) if std::env::var_os("CI").is_some() => panic!("chromium must be installed in CI: {problem}"),
        Err(_) => {
            println!("not run: chromium is not installed");
            return None;
        }
    };
    let page = String::from_utf8(output.stdout).unwrap();
    let root = page.find("<html").map(|at| &page[at..]).unwrap_or_else(|| panic!("no page: {page:?}"));
    let root = &root[..root.find('>').unwrap()];
    let attributes = root.split(" data-").skip(1).filter_map(|part| part.split_once('='));
    Some(attributes.map(|(name, value)| (name.to_owned(), value.trim_matches('"').to_owned())).collect())
}

fn directory(name: &str) -> PathBuf {
    let directory = std::env::temp_dir().join(format!("dalembert-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    directory
}

/// A bar of length 1 that turns once in 8 s, in the plane or about the vertical.
fn turning_bar(dimension: u32) -> Animation {
    let frames = (0..=800).map(|i| f64::from(i) / 100.0).map(move |t| {
        let angle = t * std::f64::consts::TAU / 8.0;
        let tip = [angle.cos(), angle.sin(), 0.0];
        (t, [[0.0; 3], tip].iter().flat_map(|p| &p[..dimension as usize]).copied().collect())
    });
    Animation::new("Turning bar", dimension, vec![Shape::Line(2)]).with_frames(frames)
}

/// The same with the tip's height over time, and its path.
fn with_charts(animation: Animation) -> Animation {
    let turn = |t: f64| t * std::f64::consts::TAU / 8.0;
    let times = || (0..=800).map(|i| f64::from(i) / 100.0);
    let height = Series::line("y", times().map(|t| Some((t, turn(t).sin()))));
    let path = Series::line("", times().map(|t| Some((turn(t).cos(), turn(t).sin())))).at_times(times());
    let axis = |name: &str| Axis::new(name, "m");
    let history = Chart::new("", Axis::new("time", "s"), axis("y")).with(height);
    animation.with_chart(history).with_chart(Chart::new("", axis("x"), axis("y")).equal().with(path))
}

fn number(seen: &HashMap<String, String>, name: &str) -> f64 {
    seen[name].parse().unwrap()
}

fn tip(seen: &HashMap<String, String>) -> [f64; 2] {
    pixel(seen, "point")
}

fn pixel(seen: &HashMap<String, String>, name: &str) -> [f64; 2] {
    let (x, y) = seen[name].split_once(',').unwrap();
    [x.parse().unwrap(), y.parse().unwrap()]
}

#[test]
fn a_paused_page_shows_the_time_it_is_asked_for() {
    let directory = directory("paused");
    std::fs::write(directory.join("bar.html"), turning_bar(2).to_html()).unwrap();
    let at = |address: &str| look(&directory, address, 500);
    if let (Some(right), Some(up), Some(left)) = (at("bar.html#t=0"), at("bar.html#t=2"), at("bar.html#t=4")) {
        assert_eq!((number(&right, "t"), number(&up, "t"), number(&left, "t")), (0.0, 2.0, 4.0));
        assert_eq!(up["playing"], "false");
        let ([x0, y0], [x1, y1], [x2, y2]) = (tip(&right), tip(&up), tip(&left));
        assert!((y0 - y2).abs() < 0.1 && (x1 - (x0 + x2) / 2.0).abs() < 0.1, "{right:?} {up:?} {left:?}");
        let radius = (x0 - x2) / 2.0;
        assert!(radius > 100.0 && (y0 - y1 - radius).abs() < 0.1, "axes are not equal: {right:?} {up:?}");
    }
    std::fs::remove_dir_all(directory).unwrap();
}

#[test]
fn playing_moves_the_mechanism() {
    let directory = directory("playing");
    std::fs::write(directory.join("bar.html"), turning_bar(2).to_html()).unwrap();
    let (paused, playing) = (look(&directory, "bar.html#t=1.5", 1500), look(&directory, "bar.html#t=1.5&play", 1500));
    if let (Some(paused), Some(playing)) = (paused, playing) {
        assert_eq!((number(&paused, "t"), playing["playing"].as_str()), (1.5, "true"));
        assert!((1.8..4.0).contains(&number(&playing, "t")), "{playing:?}");
        let ([x0, _], [x1, _]) = (tip(&paused), tip(&playing));
        assert!(x1 < x0 - 20.0, "{paused:?} {playing:?}");
    }
    std::fs::remove_dir_all(directory).unwrap();
}

#[test]
fn a_run_stops_at_its_end_and_a_mode_shape_starts_again() {
    let directory = directory("end");
    std::fs::write(directory.join("run.html"), turning_bar(2).to_html()).unwrap();
    let mode = Animation { repeat: true, ..turning_bar(2) };
    std::fs::write(directory.join("mode.html"), mode.to_html()).unwrap();
    let at = |address: &str| look(&directory, address, 1500);
    if let (Some(run), Some(mode)) = (at("run.html#t=7.5&play"), at("mode.html#t=7.5&play")) {
        assert_eq!((number(&run, "t"), run["playing"].as_str()), (8.0, "false"));
        assert!(number(&mode, "t") < 4.0 && mode["playing"] == "true", "{mode:?}");
    }
    std::fs::remove_dir_all(directory).unwrap();
}

#[test]
fn a_view_in_space_can_be_turned() {
    let directory = directory("space");
    std::fs::write(directory.join("bar.html"), turning_bar(3).to_html()).unwrap();
    // Looking along −y onto a horizontal bar that points along x, then from a quarter turn further.
    let at = |azimuth: f64| look(&directory, &format!("bar.html#t=0&elevation=0&azimuth={azimuth}"), 500);
    if let (Some(side), Some(end)) = (at(-std::f64::consts::FRAC_PI_2), at(0.0)) {
        let ([x0, y0], [x1, y1]) = (tip(&side), tip(&end));
        assert!(x0 - x1 > 100.0 && (y0 - y1).abs() < 0.1, "{side:?} {end:?}");
    }
    std::fs::remove_dir_all(directory).unwrap();
}

#[test]
fn keys_slider_and_mouse_are_heard() {
    let directory = directory("controls");
    let after = |name: &str, dimension: u32, script: &str| {
        let page = turning_bar(dimension).to_html().replace("</html>", &format!("<script>{script}</script></html>"));
        std::fs::write(directory.join(name), page).unwrap();
        look(&directory, name, 500)
    };
    let space = "document.body.dispatchEvent(new KeyboardEvent('keydown', {key: ' ', bubbles: true}))";
    let slide = "slider.value = 0.25; slider.dispatchEvent(new Event('input'))";
    let drag = "canvas.dispatchEvent(new PointerEvent('pointermove', {movementX: 200, buttons: 1}))";
    let played = after("space.html", 2, space);
    let paused = after("twice.html", 2, &format!("{space}; {space}"));
    let (slid, still, turned) =
        (after("slide.html", 2, slide), after("still.html", 3, ""), after("drag.html", 3, drag));
    if let (Some(played), Some(paused), Some(slid), Some(still), Some(turned)) = (played, paused, slid, still, turned) {
        assert!(played["playing"] == "true" && number(&played, "t") > 0.1, "{played:?}");
        assert!(paused["playing"] == "false" && number(&paused, "t") < 0.1, "{paused:?}");
        assert_eq!(number(&slid, "t"), 2.0);
        assert!((tip(&still)[0] - tip(&turned)[0]).abs() > 20.0, "{still:?} {turned:?}");
    }
    std::fs::remove_dir_all(directory).unwrap();
}

#[test]
fn a_marker_runs_along_the_curve() {
    let directory = directory("marker");
    std::fs::write(directory.join("bar.html"), with_charts(turning_bar(2)).to_html()).unwrap();
    let at = |t: u32| look(&directory, &format!("bar.html#t={t}"), 500);
    if let (Some(start), Some(up), Some(half), Some(down)) = (at(0), at(2), at(4), at(6)) {
        let [start, up, half, down] = [start, up, half, down].map(|seen| (tip(&seen), pixel(&seen, "marker")));
        // The mechanism is on the left of the charts, and time runs evenly to the right.
        assert!(start.0[0] < start.1[0]);
        assert!((half.1[0] - start.1[0] - 2.0 * (up.1[0] - start.1[0])).abs() < 0.1, "{start:?} {up:?} {half:?}");
        assert!((start.1[1] - half.1[1]).abs() < 0.1 && (up.1[1] + down.1[1] - 2.0 * half.1[1]).abs() < 0.1);
        assert!(up.1[1] < half.1[1] - 20.0, "{up:?} {half:?}");
    }
    std::fs::remove_dir_all(directory).unwrap();
}

#[test]
fn a_click_into_a_chart_sets_the_time() {
    let directory = directory("click");
    let after = |name: &str, script: &str| {
        let page =
            with_charts(turning_bar(2)).to_html().replace("</html>", &format!("<script>{script}</script></html>"));
        std::fs::write(directory.join(name), page).unwrap();
        look(&directory, name, 500)
    };
    let event = |kind: &str, x: &str, y: &str| {
        format!(
            "canvas.dispatchEvent(new PointerEvent('{kind}', {{clientX: canvas.getBoundingClientRect().left + {x}, \
                 clientY: canvas.getBoundingClientRect().top + {y}, buttons: 1}}));"
        )
    };
    // A pointer that a script makes up cannot be captured.
    let free = "canvas.setPointerCapture = () => {};";
    let middle = ["charts[0].across(4)", "charts[0].up(0)"];
    let click = event("pointerdown", middle[0], middle[1]);
    let drag = event("pointermove", "charts[0].across(6)", middle[1]);
    let left = event("pointerdown", "charts[1].across(0)", "charts[1].up(1)");
    let beside = event("pointerdown", "width / 2", "height / 2");
    let clicked = after("click.html", &format!("{free}{click}"));
    let dragged = after("drag.html", &format!("{free}{click}{drag}"));
    let along = after("path.html", &format!("{free}{left}"));
    let outside = after("outside.html", &format!("{free}{beside}{drag}"));
    if let (Some(clicked), Some(dragged), Some(along), Some(outside)) = (clicked, dragged, along, outside) {
        let times = [clicked, dragged, along, outside].map(|seen| number(&seen, "t"));
        assert!(times.iter().zip([4.0, 6.0, 2.0, 0.0]).all(|(t, wanted)| (t - wanted).abs() < 0.05), "{times:?}");
    }
    std::fs::remove_dir_all(directory).unwrap();
}

/// A page after a script has run on it, which may leave what it found in the root's `data-` attributes.
fn after(directory: &Path, page: &str, address: &str, script: &str) -> Option<HashMap<String, String>> {
    let page = page.replace("</html>", &format!("<script>{{{script}}}</script></html>"));
    std::fs::write(directory.join("page.html"), page).unwrap();
    look(directory, &format!("page.html#{address}"), 500)
}

/// A coin of radius 1 whose axis goes once round the horizon in 8 s, at the middle of a larger plane.
fn coin() -> Animation {
    let frames = (0..=800).map(|i| f64::from(i) / 100.0).map(|t| {
        let angle = t * std::f64::consts::TAU / 8.0;
        (t, vec![0.0, 0.0, 0.0, angle.cos(), angle.sin(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0])
    });
    Animation::new("Coin", 3, vec![Shape::Disc, Shape::Plane]).with_frames(frames)
}

#[test]
fn the_rim_of_a_coin_is_round_and_closed_in_the_page() {
    let directory = directory("coin");
    // The ends of the rim, px; how far its end is from its beginning; the scale.
    let script = "const now = drawing(t).frame, coin = shapes[0];
        const seen = outlines(coin.kind, pointsOf(now, coin), 0, towards())[0][0].map(pixel);
        const ends = k => Math.max(...seen.map(p => p[k])) - Math.min(...seen.map(p => p[k]));
        const gap = Math.hypot(...seen[0].map((x, k) => x - seen[seen.length - 1][k]));
        Object.assign(document.documentElement.dataset, {wide: ends(0), high: ends(1), gap, scale});";
    // Looking along −x: at the coin's face, after an eighth of a turn, at its edge.
    for (t, across) in [(0, 1.0), (1, 0.5f64.sqrt()), (2, 0.0)] {
        let Some(seen) = after(&directory, &coin().to_html(), &format!("t={t}&azimuth=0&elevation=0"), script) else {
            continue;
        };
        let diameter = 2.0 * number(&seen, "scale");
        assert!(diameter > 100.0, "{seen:?}");
        assert!((number(&seen, "wide") - across * diameter).abs() < 0.5, "{seen:?}");
        assert!((number(&seen, "high") - diameter).abs() < 0.5 && number(&seen, "gap") < 0.5, "{seen:?}");
    }
    std::fs::remove_dir_all(directory).unwrap();
}

#[test]
fn solids_in_the_page_have_the_areas_that_are_seen() {
    let directory = directory("solids");
    let script = "const view = [2, -1, 2];
        const area = points => {
          const twice = points.slice(1).reduce((sum, p, i) => plus(sum, 1, cross(points[i], p)), [0, 0, 0]);
          return Math.abs(dot(twice, view)) / 2 / norm(view);
        };
        const seen = (kind, p, r) => outlines(kind, p, r, view).filter(([, face]) => face)
          .reduce((sum, [points]) => sum + area(points), 0).toFixed(4);
        const edges = [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]];
        Object.assign(document.documentElement.dataset, {sphere: seen('sphere', [[1, 1, 1]], 2), box: seen('box', edges),
          ellipsoid: seen('ellipsoid', edges), cylinder: seen('cylinder', [[0, 0, 0], [0, 3, 0]], 0.5),
          plane: seen('plane', [[0, 0, 0], [0, 0, 3]]), nothing: seen('disc', [[0, 0, NaN], [0, 0, 1]])});";
    if let Some(seen) = after(&directory, &coin().to_html(), "t=0", script) {
        // The view is [2, −1, 2]/3.
        let half_turn = std::f64::consts::PI;
        for (kind, wanted) in [
            ("sphere", 4.0 * half_turn),
            ("box", (2.0 * 24.0 + 12.0 + 2.0 * 8.0) / 3.0),
            ("ellipsoid", half_turn * 13.0 / 3.0),
            ("cylinder", 8.0f64.sqrt() + half_turn / 12.0),
            ("plane", 6.0),
            ("nothing", 0.0),
        ] {
            assert!((number(&seen, kind) - wanted).abs() <= 2e-3 * wanted, "{kind} {wanted}: {seen:?}");
        }
    }
    std::fs::remove_dir_all(directory).unwrap();
}

#[test]
fn keys_and_the_wheel_turn_and_zoom_a_view_in_space() {
    let directory = directory("view");
    let seen = |script: &str| after(&directory, &turning_bar(3).to_html(), "t=1", script);
    let key = |name: &str, shift: bool| {
        format!(
            "document.body.dispatchEvent(new KeyboardEvent('keydown', {{key: '{name}', shiftKey: {shift}, bubbles: true}}));"
        )
    };
    let wheel = "const tip = pixel(point(drawing(t).frame, shapes[0], 1)), box = canvas.getBoundingClientRect();
        canvas.dispatchEvent(new WheelEvent('wheel', {deltaY: -300, clientX: box.left + tip[0], clientY: box.top + tip[1]}));
        document.documentElement.dataset.zoom = zoom;";
    let turned = seen(&key("ArrowLeft", true));
    let raised = seen(&key("ArrowUp", true));
    let later = seen(&key("ArrowRight", false));
    let larger = seen(&format!("{}{}", key("+", true), "document.documentElement.dataset.zoom = zoom;"));
    let restored = seen(&[key("ArrowLeft", true), key("-", false), key("0", false)].concat());
    let (still, wheeled) = (seen(""), seen(wheel));
    if let (Some(still), Some(turned), Some(raised), Some(later)) = (&still, turned, raised, later) {
        assert!((tip(still)[0] - tip(&turned)[0]).abs() > 2.0 && turned["t"] == still["t"], "{still:?} {turned:?}");
        assert!((tip(still)[1] - tip(&raised)[1]).abs() > 1.0, "{still:?} {raised:?}");
        assert!(number(&later, "t") > 1.0, "{later:?}");
    }
    if let (Some(still), Some(larger), Some(restored), Some(wheeled)) = (still, larger, restored, wheeled) {
        assert_eq!((number(&larger, "zoom"), tip(&restored)), (1.25, tip(&still)));
        // What is under the pointer stays there, up to the whole pixels of an event.
        assert!(number(&wheeled, "zoom") > 1.3, "{wheeled:?}");
        let away = |k: usize| (tip(&wheeled)[k] - tip(&still)[k]).abs();
        assert!(away(0) < 1.0 && away(1) < 1.0, "{still:?} {wheeled:?}");
    }
    std::fs::remove_dir_all(directory).unwrap();
}
