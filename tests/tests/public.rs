//! Mechanisms of public reports of other tools, on which those went wrong: each with a value of its own, by hand.

use dalembert::mechanism::{Interpreted, System};
use dalembert::{Run, Settings, simulate};
use dalembert_symbolic::lower::compile;

/// The default scene of a model file.
fn run(text: &str) -> Run {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    let mut system = Interpreted::new(program, text);
    let settings = Settings::new(&system.scene(0));
    simulate(&mut system, &settings).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// What a run has at its end of a coordinate or rate, within this.
#[track_caller]
fn ends_with(run: &Run, name: &str, value: f64, within: f64) {
    let found = run.last().get(name).unwrap_or_else(|| panic!("no {name}"));
    assert!((found - value).abs() <= within, "{name} is {found}, not {value}");
}

/// A unit mass on the x axis with these keys besides.
fn mass(keys: &str) -> String {
    format!(
        "name: Mass\nparameters: {{m: 1, k: 1, F: 1}}\ncoordinates: {{x: 1}}\n\
        bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\n{keys}\n"
    )
}

/// A solver whose steps are longer than a pulse passes it: x = cos(t − 53) − cos(t − 50).
#[test]
fn a_pulse_long_after_the_start_of_an_oscillator_is_met() {
    let spring = "springs: {s: {stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}\n";
    let at = |pulse: &str| {
        run(&mass(&format!(
            "{spring}forces: {{f: {{on: b, force: \"[F*({pulse}), 0]\"}}}}\n\
            scene: {{start: {{x: 0}}, until: 100, tolerance: 1e-10}}"
        )))
    };
    let expected = 47_f64.cos() - 50_f64.cos();
    ends_with(&at("step(t - 50) - step(t - 53)"), "x", expected, 1e-8);
    // Rounded shoulders of width w take π²w²/24 of it, about.
    ends_with(&at("(tanh(100*(t - 50)) - tanh(100*(t - 53)))/2"), "x", expected, 1e-4);
}

/// Work of a narrow push on a coasting mass: v² = 1 + 2 F w √π.
#[test]
fn a_narrow_push_on_a_coasting_mass_is_met() {
    let text = mass(
        "forces: {f: {on: b, force: \"[F*exp(-((x - 50)/0.1)^2), 0]\"}}\n\
        scene: {start: {x': 1}, until: 100, tolerance: 1e-10}",
    );
    ends_with(&run(&text), "x'", (1.0 + 0.2 * std::f64::consts::PI.sqrt()).sqrt(), 1e-8);
}

/// A force that changes its sign 42 times a second pushes from rest: the mean speed is F/(4·21 Hz).
#[test]
fn forty_two_thousand_switches_of_a_force_are_met() {
    let text = mass(
        "forces: {f: {on: b, force: \"[F*sign(sin(2*pi*21*t)), 0]\"}}\n\
        scene: {start: {x: 0}, until: 1000, tolerance: 1e-10}",
    );
    let run = run(&text);
    ends_with(&run, "x", 1000.0 / 84.0, 1e-7);
    ends_with(&run, "x'", 0.0, 1e-8);
}

/// Beside metres a motion of nanometres is solved too: u = a cos 10 t.
#[test]
fn a_nanometre_beside_a_metre_keeps_its_digits() {
    let text = "name: Two\nparameters: {m: 1 kg, k: 1 N/m, mu: 1e-6 kg, kappa: 1e-4 N/m}\ncoordinates: {x: m, u: m}\n\
        bodies: {big: {mass: m, position: \"[x, 0]\"}, tip: {mass: mu, position: \"[0, u]\"}}\nsprings:\n  \
        s: {stretch: x, stiffness: k, along: \"[1, 0]\", on: big}\n  \
        t: {stretch: u, stiffness: kappa, along: \"[0, 1]\", on: tip}\n\
        scene: {start: {x: 1, u: 1e-9}, until: 100}\n";
    let run = run(text);
    ends_with(&run, "u", 1e-9 * 1000_f64.cos(), 1e-15);
    ends_with(&run, "x", 100_f64.cos(), 1e-7);
}

/// A ball strikes an elastic floor, and gravity ends at that instant: it rises at √(2 g h) for ever.
#[test]
fn gravity_that_ends_at_an_impact_ends_there() {
    let text = "name: Flip\nparameters: {m: 1 kg, g: 9.8 m/s^2}\ncoordinates: {y: m}\n\
        bodies: {ball: {mass: m, position: \"[0, y]\"}}\n\
        forces: {weight: {on: ball, force: \"[0, -m*g]\", phase: heavy}}\nconstraints: {floor: y}\n\
        phases: {heavy: [], light: [], lying: [floor]}\n\
        events: {hit: {when: y, direction: falling, then: [{impact: 1, along: floor}, light]}}\n\
        scene: {start: {y: 50}, until: 15, tolerance: 1e-9}\n";
    let (fall, speed) = ((100.0_f64 / 9.8).sqrt(), (2.0 * 9.8 * 50.0_f64).sqrt());
    let run = run(text);
    ends_with(&run, "y", speed * (15.0 - fall), 1e-6);
    ends_with(&run, "y'", speed, 1e-8);
}

/// Impacts that lose energy end after (v₁/g)(1 + e)/(1 − e), and never below the floor.
#[test]
fn a_ball_that_bounces_ever_lower_slides_on() {
    let text = "name: Zeno\nparameters: {m: 1 kg, g: 9.8 m/s^2, e: 0.5 1, h: 1 m}\ncoordinates: {x: m, y: m}\n\
        bodies: {ball: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\nconstraints: {floor: y + h}\n\
        phases: {flight: [], sliding: [floor]}\n\
        events: {hit: {when: y + h, direction: falling, phase: flight, then: {impact: e, along: floor}}}\n\
        scene: {start: {x': 1, y': 1}, until: 2, tolerance: 1e-9}\n";
    let run = run(text);
    ends_with(&run, "x", 2.0, 1e-8);
    ends_with(&run, "y", -1.0, 1e-9);
    let (first, speed) = ((1.0 + 20.6_f64.sqrt()) / 9.8, 20.6_f64.sqrt());
    let last = run.events.last().expect("impacts").state.t;
    assert!((last - (first + 2.0 * 0.5 * speed / 9.8 / 0.5)).abs() < 1e-3, "{last}");
}

/// A cannon ball with drag in proportion to its speed lands where (v₀ sin α + 1)(1 − e⁻ᵗ) = t, and stops there.
#[test]
fn a_cannon_ball_with_linear_drag_lands_where_it_does() {
    let text = "name: Cannon\nparameters: {m: 1 kg, c: 1 kg/s, g: 1 m/s^2, v0: 1 m/s, th: 45 deg}\n\
        coordinates: {x: m, y: m}\nbodies: {ball: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\n\
        forces: {drag: {on: ball, force: -c*velocity(ball)}}\n\
        events: {land: {when: y, direction: falling, then: stop}}\n\
        scene: {start: {x': v0*cos(th), y': v0*sin(th)}, until: 1000}\n";
    let s = std::f64::consts::FRAC_1_SQRT_2;
    let t = (0..60).fold(1.5_f64, |t, _| (s + 1.0) * (1.0 - (-t).exp()));
    let run = run(text);
    assert!((run.last().t - t).abs() < 1e-8, "{} {t}", run.last().t);
    ends_with(&run, "x", s * (1.0 - (-t).exp()), 1e-8);
}

/// Four equal masses on a ring with dashpots between them: a turn that nothing damps, and two equal modes.
#[test]
fn a_free_ring_with_repeated_damped_modes_moves_by_the_sum_of_its_modes() {
    let text = "name: Ring\nsizes: {n: 4}\nparameters: {m: 1 kg, k: 1 N/m, c: 0.2 N*s/m}\n\
        coordinates: {\"u[i in 1..n]\": m}\nbodies: {\"p[i in 1..n]\": {mass: m, position: \"[u[i], 0]\"}}\n\
        springs: {\"s[i in 1..n]\": {stretch: \"u[mod(i, n) + 1] - u[i]\", stiffness: k}}\n\
        dampers: {\"d[i in 1..n]\": {rate: \"u[mod(i, n) + 1]' - u[i]'\", damping: c}}\n\
        scene: {start: {\"u[1]\": 1, \"u[1]'\": 0.4}, until: 10, tolerance: 1e-10}\n";
    let t = 10.0_f64;
    // f'' + c μ f' + k μ f = 0 from f = 1, f' = 0.4.
    let mode = |mu: f64| {
        let decay = 0.1 * mu;
        let omega = (mu - decay * decay).sqrt();
        (-decay * t).exp() * ((omega * t).cos() + (0.4 + decay) / omega * (omega * t).sin())
    };
    let run = run(text);
    for (name, twice) in [("u[1]", 2.0), ("u[2]", 0.0), ("u[3]", -2.0)] {
        let alternating = if name == "u[2]" { -1.0 } else { 1.0 };
        let expected = 0.25 * (1.0 + 0.4 * t + twice * mode(2.0) + alternating * mode(4.0));
        ends_with(&run, name, expected, 1e-8);
    }
}

/// A disc on a springy shaft: both precessions, ω = √((γ/2)² + k/J) ± γ/2 with γ = W Jp/J.
#[test]
fn a_gyroscopic_disc_has_two_precessions() {
    let text = "name: Disc\nparameters: {J: 0.1 kg*m^2, Jp: 0.18 kg*m^2, k: 1e4 N*m, W: 100 rad/s}\n\
        coordinates: {a: rad, b: rad}\nkinetic_energy: J/2*(a'^2 + b'^2) - Jp*W*(a'*b - a*b')/2\n\
        potential_energy: k/2*(a^2 + b^2)\nscene: {start: {a: 0.01}, until: 1}\n";
    let half = 0.5 * 100.0 * 0.18 / 0.1;
    let root = (half * half + 1e4_f64 / 0.1).sqrt();
    let (fast, slow) = (root + half, root - half);
    let run = run(text);
    let amplitude = 0.01 / (fast + slow);
    ends_with(&run, "a", amplitude * (slow * fast.cos() + fast * slow.cos()), 1e-9);
    let b = run.last()["b"].abs();
    assert!((b - (amplitude * (slow * fast.sin() - fast * slow.sin())).abs()).abs() < 1e-9, "{b}");
}

/// A soft spring beside one that is 10¹⁵ times as stiff gives way: F/k.
#[test]
fn an_equilibrium_of_a_soft_spring_beside_a_stiff_one_is_found() {
    let text = "name: Eq\nparameters: {k1: 1e12 N/m, k2: 1e-3 N/m, F: 0.05 N, m: 1 kg}\ncoordinates: {x: m, y: m}\n\
        kinetic_energy: m*(x'^2 + y'^2)/2\npotential_energy: k1*x^2/2 + k2*y^2/2\ngeneralized_forces: {y: F}\n";
    let folder = std::env::temp_dir().join(format!("dalembert-public-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("eq.yaml");
    std::fs::write(&path, text).expect("written");
    let mut out = Vec::new();
    let arguments = ["dalembert", "modes", path.to_str().expect("text")];
    dalembert::cli::run(&[], arguments.iter(), &mut out).unwrap_or_else(|problem| panic!("{problem}"));
    let printed = String::from_utf8(out).expect("text");
    assert!(printed.contains("y = 50 m"), "{printed}");
}
