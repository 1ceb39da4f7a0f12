//! Equilibria, what is zero but for rounding, modes.

use dalembert::linear::{
    Guess, Kind, LinearError, Linearised, Mode, equilibrium_near, linearise, linearise_constrained, linearise_tangent,
};
use dalembert::mechanism::{Method, System};

use super::{case, folder, printed, program, text_of};

/// The linear model of a file without constraints about the rest nearest to 0.
fn free(text: &str) -> Linearised {
    let system = case(text).system;
    let rest = equilibrium_near(&system, &Guess::at(&vec![0.0; system.len()])).expect("a rest");
    linearise(&system, &rest).expect("M, C and K")
}

fn modes(text: &str) -> Vec<Mode> {
    free(text).modes().expect("modes")
}

fn close(found: f64, expected: f64, part: f64) {
    assert!((found - expected).abs() <= part * expected.abs(), "{found} for {expected}");
}

/// At rest `e' = r - x` asks for x = r; the integral part then carries the load, e = load/ki.
#[test]
fn integral_control_rests_where_its_error_is_zero() {
    for scale in [1.0, 1e-9, 1e9] {
        let mut system = case(&text_of("integral_control")).system;
        let names: Vec<String> = system.description().parameters.iter().map(|known| known.name.to_string()).collect();
        for (index, name) in names.iter().enumerate() {
            if ["r", "load"].contains(&name.as_str()) {
                system.set_parameter(index, scale * system.parameters()[index]);
            }
        }
        let found = linearise_tangent(&system, &Guess::at(&[0.0, 0.0]), false).expect("a rest");
        close(found.equilibrium.q[0], scale, 1e-12);
        close(found.equilibrium.q[1], 0.3 * scale, 1e-12);
        assert_eq!(found.equilibrium.v, [0.0, 0.0]);
        // λ³ + 4.5 λ² + 20 λ + 10 = 0.
        for value in &found.analysis.eigenvalues {
            let left = value * value * value + value * value * 4.5 + value * 20.0 + 10.0;
            assert!(left.norm() < 1e-11, "{value}");
        }
        assert_eq!(found.multipliers, [0.0]);
    }
}

/// A shaft that a constraint turns at a given rate does not rest: the steady motion is found as before.
#[test]
fn a_driven_shaft_still_turns_steadily() {
    let text = "\
name: Shaft
about: A wheel turned at a constant rate.
parameters: {J: 1 kg*m^2, W: 3 rad/s}
coordinates: {phi: rad}
kinetic_energy: J*phi'^2/2
constraints: {drive: phi' = W}
scene: {start: {phi: 0}, until: 1}
";
    let system = case(text).system;
    let found = linearise_tangent(&system, &Guess::at(&[0.0]), false).expect("a steady motion");
    close(found.equilibrium.v[0], 3.0, 1e-12);
}

/// Where the only spring is at its rest length no force acts at all, and none is left that could measure rounding.
#[test]
fn a_lever_on_which_no_force_acts_rests() {
    let system = case(&text_of("lever_without_force")).system;
    let found = linearise_constrained(&system, &Guess::at(&[0.5, 1.5]), false).expect("a rest");
    let [al, be] = [found.linear.equilibrium.q[0], found.linear.equilibrium.q[1]];
    close(al, 0.5, 1e-14);
    let link = [0.3 + 0.2 * be.cos() - 0.1 * al.cos(), 0.2 * be.sin() - 0.1 * al.sin()];
    close(link[0].hypot(link[1]), 0.3, 1e-13);
    // The link's length stays: be' = ratio al'.
    let turn = |x: [f64; 2]| link[0] * x[0] + link[1] * x[1];
    let ratio = turn([-0.1 * al.sin(), 0.1 * al.cos()]) / turn([-0.2 * be.sin(), 0.2 * be.cos()]);
    let modes = found.linear.modes().expect("modes");
    close(modes[0].omega, (4000.0 / (0.02 + 0.5 * ratio * ratio)).sqrt(), 1e-12);
    assert_eq!((modes.len(), found.multipliers), (1, vec![0.0]));
}

/// A force of 1e-6 N m that nothing balances is no rounding beside a spring of 4000 N m/rad.
#[test]
fn a_small_force_on_a_lever_is_no_rounding() {
    let text = text_of("lever_without_force").replace("k*(al - al0)^2/2", "k*(al - al0)^2/2 - tau*be");
    let text = text.replace("al0: 0.5 rad", "al0: 0.5 rad, tau: 1e-6 N*m");
    let system = case(&text).system;
    let rest = linearise_constrained(&system, &Guess::at(&[0.5, 1.5]), false).expect("a rest");
    assert!(rest.multipliers[0].abs() > 1e-7 && (rest.linear.equilibrium.q[0] - 0.5).abs() > 1e-12);
    let here = Guess::at(&[0.5, rest.linear.equilibrium.q[1] + 1e-3]);
    assert!(linearise_constrained(&system, &here, true).is_err());
}

/// Bodies of mass 0 with inertia have no centre of mass; one rotation of all and four pairs remain of five coordinates.
#[test]
fn bodies_without_mass_have_a_rotation_and_modes() {
    let text = printed("modes", "drivetrain", &[]);
    assert!(text.contains("1: rigid, no stiffness") && text.contains("  5: damped"), "{text}");
    let direct = text_of("drivetrain").replace("n: 3.5", "n: 1");
    let folder = folder("drivetrain");
    let path = folder.join("direct.yaml");
    std::fs::write(&path, direct).expect("written");
    let text = super::program(&["modes", path.to_str().expect("a path")]).expect("modes");
    assert!(text.contains("rotation about the centre of mass"), "{text}");
    std::fs::remove_dir_all(folder).expect("removed");
}

fn equal_oscillators(n: usize, c: f64) -> String {
    format!(
        "\
name: Equal
about: Equal damped oscillators.
sizes: {{n: {n}}}
coordinates: {{\"x[i in 1..n]\": 1}}
kinetic_energy: sum(x[i]'^2/2, i in 1..n)
potential_energy: \"sum(x[i]^2/2, i in 1..n)\"
dissipation: {c}*sum(x[i]'^2/2, i in 1..n)
scene: {{start: {{\"x[1]\": 1}}, until: 1}}
"
    )
}

#[test]
fn equal_damped_oscillators_have_shapes_of_their_own() {
    for (n, c) in [(2, 0.5), (4, 0.1), (7, 1e-6), (3, -0.1), (3, 3.0), (3, 2.0)] {
        let linear = free(&equal_oscillators(n, c));
        let analysis = dalembert::linear::complex_modes(&linear).expect("modes");
        assert!(analysis.secular.is_empty(), "{n} {c}");
        let roots = [-0.5 * c + (0.25 * c * c - 1.0).max(0.0).sqrt(), -0.5 * c - (0.25 * c * c - 1.0).max(0.0).sqrt()];
        for mode in &analysis.modes {
            let nearest = roots.iter().map(|root| (mode.eigenvalue.re - root).abs()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-14, "{n} {c}: {}", mode.eigenvalue);
            assert!(mode.shape.iter().all(|x| x.im == 0.0), "{n} {c}: {:?}", mode.shape);
        }
        // As many shapes as modes, orthonormal.
        let oscillate = analysis.modes.iter().filter(|mode| mode.eigenvalue.im > 0.0).collect::<Vec<_>>();
        for (i, a) in oscillate.iter().enumerate() {
            for (j, b) in oscillate.iter().enumerate() {
                let dot: f64 = a.shape.iter().zip(&b.shape).map(|(a, b)| a.re * b.re).sum();
                assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-13);
            }
        }
        assert_eq!(oscillate.len(), if c.abs() < 2.0 { n } else { 0 });
        let kind = if c < 0.0 {
            Kind::Unstable
        } else if c < 2.0 {
            Kind::Damped
        } else if c == 2.0 {
            Kind::Critical
        } else {
            Kind::Overdamped
        };
        assert!(analysis.modes.iter().all(|mode| mode.kind == kind), "{n} {c}");
    }
}

/// Two oscillators one of which drives the other at its own frequency are secular indeed.
#[test]
fn an_oscillator_that_drives_its_equal_is_secular() {
    let text = "\
name: Driven
about: One oscillator drives another of the same frequency.
parameters: {m: 1 kg, k: 1 N/m, c: 0.1 N*s/m}
coordinates: {x: m, y: m}
bodies: {a: {mass: m, position: \"[x, 0]\"}, b: {mass: m, position: \"[0, y]\"}}
forces: {f: {on: a, force: \"[y*k - k*x - c*x', 0]\"}, g: {on: b, force: \"[0, -k*y - c*y']\"}}
scene: {start: {x: 1}, until: 1}
";
    let found = modes(text);
    assert!(found.len() == 2 && found.iter().all(|mode| mode.secular), "{found:?}");
}

/// x'' = y, y'' = 0 and longer chains: all eigenvalues are 0, of which rounding makes none that oscillates or grows.
#[test]
fn chains_of_integrators_have_no_eigenvalues_but_zero() {
    for (force, expected) in [("k*y", 4), ("k*y + 0.3*b*x' - 0.3*b*x'", 4), ("b*y'", 4)] {
        let text = format!(
            "\
name: Chain
about: A mass pushed by what another does.
parameters: {{m: 1 kg, k: 1 N/m, b: 1 N*s/m}}
coordinates: {{x: m, y: m}}
bodies: {{a: {{mass: m, position: \"[x, 0]\"}}, d: {{mass: m, position: \"[0, y]\"}}}}
forces: {{f: {{on: a, force: \"[{force}, 0]\"}}}}
scene: {{start: {{x: 0}}, until: 1}}
"
        );
        let analysis = dalembert::linear::complex_modes(&free(&text)).expect("modes");
        let zeros = analysis.eigenvalues.iter().filter(|value| value.norm() == 0.0).count();
        assert_eq!(zeros, expected, "{force}: {:?}", analysis.eigenvalues);
        assert!(analysis.modes.iter().all(|mode| mode.kind == Kind::Rigid) && analysis.defective, "{force}");
    }
}

/// K = diag(1, 2), M = [1, 1; 1, 1 + d]: the fast frequency is √(3/d) but for what rounding makes of 1 + d.
#[test]
fn an_ill_conditioned_mass_matrix_leaves_fewer_digits() {
    let of = |d: f64| {
        format!(
            "\
name: NearSingular
about: A mass matrix that is nearly singular.
parameters: {{d: {d:e}}}
coordinates: {{x: 1, y: 1}}
kinetic_energy: (x'^2 + 2*x'*y' + (1 + d)*y'^2)/2
potential_energy: (x^2 + 2*y^2)/2
scene: {{start: {{x: 1}}, until: 1}}
"
        )
    };
    for d in [1e-13, 3e-12, 1e-8, 1e-4] {
        let found = modes(&of(d));
        // d ω⁴ − (3 + d) ω² + 2 = 0.
        let expected = ((3.0 + d + ((3.0 + d) * (3.0 + d) - 8.0 * d).sqrt()) / (2.0 * d)).sqrt();
        let missed = (found[1].omega / expected - 1.0).abs();
        assert!(missed <= found[1].uncertainty, "{d}: {missed} beside {}", found[1].uncertainty);
        assert!(found[1].uncertainty < 1e-15 / d, "{d}: {}", found[1].uncertainty);
        assert!(found[0].uncertainty < 1e-15, "{d}");
    }
    let text = modes(&of(1e-13))[1].to_string();
    assert!(text.contains("omega = 5.5e6 rad/s"), "{text}");
    assert!(modes(&of(1e-4))[1].to_string().contains("omega = 173.206 rad/s"));
}

/// Each complex shape is turned so that what carries most of its energy is real.
#[test]
fn damped_shapes_are_real_where_they_are_largest() {
    let text = "\
name: Pair
about: Two masses, one of them damped.
parameters: {m: 1 kg, k: 1 N/m, c: 0.4 N*s/m}
coordinates: {x: m, y: m}
kinetic_energy: m*(x'^2 + 4*y'^2)/2
potential_energy: k*(x^2 + (y - x)^2)/2
dissipation: c*x'^2/2
scene: {start: {x: 1}, until: 1}
";
    for mode in modes(text) {
        let energy = [mode.shape[0].norm(), 2.0 * mode.shape[1].norm()];
        let largest = usize::from(energy[1] > energy[0]);
        assert!(mode.shape[largest].im.abs() < 1e-15 && mode.shape[1 - largest].im.abs() > 1e-3, "{mode:?}");
        assert!(mode.shape[0].re > 0.0);
    }
}

/// A free body by a quaternion of unit length: M is singular along it, the constraint holds it.
const QUATERNION: &str = r#"
name: Quaternion
parameters: {A: 1 kg*m^2, B: 2 kg*m^2, C: 2.5 kg*m^2}
coordinates: {q0: 1, q1: 1, q2: 1, q3: 1}
define:
  w1: 2*(-q1*q0' + q0*q1' + q3*q2' - q2*q3')
  w2: 2*(-q2*q0' - q3*q1' + q0*q2' + q1*q3')
  w3: 2*(-q3*q0' + q2*q1' - q1*q2' + q0*q3')
kinetic_energy: A*w1^2/2 + B*w2^2/2 + C*w3^2/2
constraints: {unit_q: q0^2 + q1^2 + q2^2 + q3^2 - 1}
outputs: {w1: w1, w2: w2, w3: w3}
scene: {start: {q0: 1, q1: 0, q2: 0, q3: 0, q0': 0, q1': 0.01, q2': 1, q3': 0.02}, until: 20}
"#;

/// Its angular velocity after 20 s by Euler's equations, A w1' = (B - C) w2 w3 and so on.
fn euler() -> [f64; 3] {
    let (a, b, c) = (1.0, 2.0, 2.5);
    let rate = |w: [f64; 3]| [(b - c) / a * w[1] * w[2], (c - a) / b * w[2] * w[0], (a - b) / c * w[0] * w[1]];
    let (mut w, h) = ([0.02, 2.0, 0.04], 1e-3);
    for _ in 0..20_000 {
        let at = |k: [f64; 3], part: f64| [0, 1, 2].map(|i| w[i] + part * h * k[i]);
        let k1 = rate(w);
        let k2 = rate(at(k1, 0.5));
        let k3 = rate(at(k2, 0.5));
        let k4 = rate(at(k3, 1.0));
        w = [0, 1, 2].map(|i| w[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    w
}

#[test]
fn a_body_by_a_quaternion_ran_away_where_its_inertia_is_singular() {
    let exact = euler();
    // Beside the start with nothing but a turn about q2, M's first entry is next to nothing.
    for start in ["q1: 0,", "q1: 1e-10,", "q1: 1e-16,"] {
        for tolerance in [1e-9, 1e-12] {
            let mut case = case(&QUATERNION.replace("q1: 0,", start));
            (case.settings.tolerance, case.settings.digits) = (tolerance, true);
            let run = case.run();
            let name = format!("{start} at {tolerance}");
            assert!(
                run.energy_balance.is_some_and(|drift| drift < 100.0 * tolerance),
                "{name}: {:?}",
                run.energy_balance
            );
            assert!(run.digits("q0").is_some_and(|digits| digits >= 3), "{name}: {:?}", run.digits("q0"));
            let off = ["w1", "w2", "w3"].iter().zip(exact).map(|(w, exact)| (run.last()[*w] - exact).abs());
            let off = off.fold(0.0, f64::max);
            assert!(off < 1e4 * tolerance, "{name}: {off}");
        }
    }
}

/// Its forces balance to a rounding, not to zero; a propagator's steps are as long as the vibration asks.
#[test]
fn what_hangs_at_rest_is_held_by_the_exact_method_however_long() {
    let hung = |away: f64| {
        case(&format!(
            "name: Hung\nparameters: {{m: 0.7 kg, k: 3 N/m, g: 9.81 m/s^2, away: {away} m}}\ncoordinates: {{x: m}}\n\
             bodies: {{b: {{mass: m, position: \"[0, -x]\"}}}}\ngravity: [0, -g]\npotential_energy: k*x^2/2\n\
             scene: {{start: {{x: m*g/k + away}}, until: 1e9}}\n"
        ))
    };
    let mut rests = hung(0.0);
    rests.settings.method = Method::Exact;
    let run = rests.run();
    assert!(run.work.steps < 10 && run.last()["x'"] == 0.0, "{:?}", run.work);
    let mut swings = hung(0.1);
    (swings.settings.method, swings.settings.until) = (Method::Exact, 100.0);
    let omega = (3.0_f64 / 0.7).sqrt();
    close(swings.run().last()["x'"], -0.1 * omega * (100.0 * omega).sin(), 1e-9);
}

/// A cube that stands on a corner, as angles that turn about [1, 1, 1] in the end: nothing depends on the last one, though 3 (1/√3)² is 1 only to
/// 32 digits.
#[test]
fn the_last_digits_of_a_root_were_a_stiffness() {
    let cube = "name: Cube\nparameters: {m: 1 kg, a: 0.15 m, I: 0.004 kg*m^2, g: 9.81 m/s^2}\n\
        coordinates: {al: rad, be: rad, ga: rad}\nframes: {B: {rotate: [[x, al], [y, be], [\"[1, 1, 1]\", ga]]}}\n\
        points: {O: [0, 0, 0]}\nbodies: {cube: {mass: m, inertia: [I, I, I], frame: B, position: \"a/2*(B.x + B.y + B.z)\"}}\n\
        define: {s: 1/sqrt(3)}\ngravity: \"SIGN*g*s*[1, 1, 1]\"\nscene: {start: {al: 0.1}, until: 1}\n";
    // Standing and hanging: g √3 a/2 m over the inertia about the corner.
    let rate = (9.81 * 0.075 * 3_f64.sqrt() / (0.004 + 3.0 * 0.075 * 0.075)).sqrt();
    for (sign, kind) in [("-1", Kind::Unstable), ("1", Kind::Oscillating)] {
        let modes = modes(&cube.replace("SIGN", sign));
        assert_eq!(modes.iter().filter(|mode| mode.kind == Kind::Rigid).count(), 1, "{modes:?}");
        assert_eq!(modes.iter().filter(|mode| mode.kind == kind).count(), 2, "{modes:?}");
        let swings = modes.iter().filter(|mode| mode.kind == Kind::Oscillating);
        swings.for_each(|mode| close(mode.omega, rate, 1e-12));
    }
}

/// What is no body may move as well, and then a motion is no translation of the whole.
#[test]
fn free_motions_are_named_by_all_that_moves_in_them() {
    let folder = folder("free-motions");
    let told = |text: &str| {
        let file = folder.join("free.yaml");
        std::fs::write(&file, text).expect("a file");
        let text = program(&["modes", file.to_str().expect("a path")]).unwrap();
        let lines = text.lines().filter_map(|line| line.split_once("rigid, no stiffness")).map(|(_, rest)| rest);
        lines.map(|rest| rest.split(';').next().unwrap_or_default().to_owned()).collect::<Vec<_>>()
    };
    // A cart that rolls with a flywheel, of which nearly all of the energy is.
    let flywheel = "name: F\nparameters: {m: 1 kg, J: 1 kg*m^2, k: 4 N/m, r: 0.1 m}\ncoordinates: {x: m, phi: rad}\n\
        bodies: {cart: {mass: m, position: \"[x, 0]\"}}\nkinetic_energy: J*phi'^2/2\npotential_energy: k*(x - r*phi)^2/2\n";
    assert_eq!(told(flywheel), [""]);
    // A flywheel of its own leaves the cart its translation, and has no name.
    let apart = flywheel.replace("k*(x - r*phi)^2/2", "0*k*r*x");
    assert_eq!(told(&apart), [": translation along x", ""]);
    // What moves along with bodies and is a length goes with their translation.
    let along = flywheel.replace("J*phi'^2/2", "m*x'^2/2 + J*phi'^2/2").replace("r*phi)^2", "r*phi)^2*0 + k*phi^2*r*r");
    assert_eq!(told(&along), [": translation along x"]);
}

/// A wheel on a belt that an input drives, between springs.
const BELT: &str = "\
name: Belt
parameters: {R: 0.2 m, m: 1 kg, J: 0.02 kg*m^2, k: 40 N/m, kt: 0.5 N*m/rad, Y: 0 m, c: 5 N*s/m, w: 3 rad/s}
coordinates: {x: m, ph: rad}
inputs: {belt: Y*sin(w*t)}
bodies: {wh: {mass: m, inertia: J, angle: -ph, position: \"[x, R]\"}}
springs: {s: {stretch: x, stiffness: k}, q: {stretch: ph, stiffness: kt}}
dampers: {d: {rate: x', damping: c}}
constraints: {roll: x' - R*ph' - belt'}
outputs: {slip: x - R*ph - belt}
scene: {start: {x: 0.02, ph: 0.1}, until: 5}
";

/// Where `modes` says that x of a file rests.
fn rest_of(name: &str, text: &str) -> f64 {
    let folder = folder(name);
    let path = folder.join("model.yaml");
    std::fs::write(&path, text).expect("written");
    let printed = program(&["modes", path.to_str().expect("a path")]).expect("modes");
    std::fs::remove_dir_all(folder).expect("removed");
    let told = printed.split("equilibrium at x = ").nth(1).and_then(|rest| rest.split(' ').next()?.parse().ok());
    told.unwrap_or_else(|| panic!("{printed}"))
}

/// Where it starts x = R ph + belt, which the motion keeps: it rests at 0.
#[test]
fn a_row_with_an_input_s_rate_keeps_its_integral() {
    assert!(rest_of("belt", BELT).abs() < 1e-15);
    // Its run ends there, too, and does not slip on the way, while the belt moves.
    let run = case(&BELT.replace("until: 5", "until: 60")).run();
    assert!(run.last()["x"].abs() < 1e-9 && run.last()["ph"].abs() < 1e-9, "{:?}", run.last());
    let run = case(&BELT.replace("Y: 0 m", "Y: 0.05 m").replace("until: 5", "until: 5, tolerance: 1e-6")).run();
    assert!(run.last()["slip"].abs() < 1e-14 && run.last()["x"].abs() > 1e-3, "{:?}", run.last());
}

/// A guess of zeros is a guess; without one integrals are those of the scene's start.
#[test]
fn a_guess_of_zeros_is_given() {
    let wheel = BELT.replace(" - belt'", "").replace("x: 0.02, ph: 0.1", "x: 0.02, ph: 0.5");
    for (guess, rest) in [("", 0.08), ("equilibrium: {x: 0, ph: 0}", 0.0), ("equilibrium: {x: 0.03, ph: 0.2}", 0.01)] {
        // x − R ph is −0.08, 0, −0.01, and k x + kt ph/R = 0.
        let x = -rest / (1.0 + 0.2_f64 * 0.2 * 40.0 / 0.5);
        let told = rest_of("zeros", &format!("{wheel}{guess}\n"));
        assert!((told - x).abs() <= 1e-5 * x.abs(), "{guess}: {told} for {x}");
    }
}

/// A spring has no direction where its ends meet: the search begins at the scene's start, and at 0 where a file says so, which is refused.
#[test]
fn a_search_for_rest_begins_where_forces_have_values() {
    let bob = "name: Bob\nparameters: {m: 1 kg, k: 200 N/m, l0: 0.3 m, g: 10 m/s^2}\ncoordinates: {x: m, y: m}\n\
               points: {hook: '[0, 0]'}\nbodies: {bob: {mass: m, position: '[y, x]'}}\ngravity: [0, -g]\n\
               springs: {coil: {between: [hook, bob], stiffness: k, rest: l0}}\nscene: {start: {x: -0.3, y: 0.2}, until: 2}\n";
    assert!((rest_of("bob", bob) + 0.35).abs() < 1e-9);
    let system = case(&format!("{bob}equilibrium: {{x: 0}}\n")).system;
    assert!(equilibrium_near(&system, &Guess::at(&[0.0, 0.0])).is_err());
}

/// An angle that the search has left at a rounding is 0: the force on the other coordinate is what was sought.
#[test]
fn a_hanging_pendulum_does_not_keep_its_cart_from_being_held() {
    let text = "name: Cart\nparameters: {M: 2 kg, m: 1 kg, l: 1 m, g: 9.81 m/s^2, k: 5 N/m}\ncoordinates: {x: m, th: rad}\ninputs: {F: 0 N}\n\
        bodies: {cart: {mass: M, position: \"[x, 0]\"}, p: {mass: m, position: \"[x + l*sin(th), -l*cos(th)]\"}}\ngravity: [0, -g]\n\
        springs: {s: {stretch: x, stiffness: k, along: ground.x, on: cart}}\nforces: {f: {on: cart, force: \"[F, 0]\"}}\nscene: {start: {x: 0}, until: 1}\n";
    let path = folder("cart").join("cart.yaml");
    std::fs::write(&path, text).expect("a file");
    for (x, force) in [("0.1", "0.5"), ("0.2", "1"), ("0.7", "3.5")] {
        let told = program(&["modes", path.to_str().expect("a path"), "--hold", &format!("x={x}"), "--solve", "F"])
            .expect("modes");
        assert!(told.contains(&format!("F = {force} N")), "{told}");
    }
}

/// A trim of a model with a state that is 0 there, as of the filter in a controller, is found although rounding moves it.
#[test]
fn a_trim_with_a_filter_at_rest_is_found() {
    let path = folder("filter_trim").join("model.yaml");
    let text = "name: Filter\nparameters: {m: 1 kg, k: 3 N/m, tau: 0.03 s, L: 1 m}\ncoordinates: {x: m}\n\
                states: {f: {unit: m/s, rate: (x' - f)/tau}}\ninputs: {u: 0 N}\nbodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
                springs: {s: {stretch: x, stiffness: k, along: ground.x, on: b}}\nforces: {act: {on: b, force: \"[u*cos(x/L), 0]\"}}\n";
    std::fs::write(&path, text).expect("a file");
    let path = path.to_str().expect("a path");
    for x in [0.1, 0.5, -0.7, 1.2] {
        let said = program(&["modes", path, "--hold", &format!("x={x}"), "--solve", "u", "--json"]).unwrap();
        let found: serde_json::Value = serde_json::from_str(&said).expect("JSON");
        let u = said.split("\"u\"").count();
        assert!(u > 1 && found["equilibrium"]["x"].as_f64().is_some_and(|found| (found - x).abs() < 1e-12), "{said}");
    }
}

/// Contacts whose sides pull, and friction beyond its limit, are told of where there are states and where the loop is sampled, too.
#[test]
fn rests_with_states_tell_of_contacts_that_pull() {
    let path = folder("pulls").join("model.yaml");
    let text = |law: &str| {
        format!(
            "name: Pulls\nparameters: {{m: 1 kg, g: 9.81 m/s^2, tau: 0.1 s, F: 15 N}}\ncoordinates: {{y: m}}\n{law}\n\
             bodies: {{b: {{mass: m, position: \"[0, y]\"}}}}\ngravity: [0, -g]\nforces: {{up: {{on: b, force: \"[0, f]\"}}}}\n\
             contacts: {{fl: {{gap: y, on: b, normal: \"[0, 1]\"}}}}\n"
        )
    };
    let state = text("states: {f: {unit: N, rate: (F - f)/tau}}");
    let sampled = text("memory: {f: 0 N}\nevents: {tk: {every: 0.1 s, then: {set: {f: F}}}}");
    for (text, more) in [(state, None), (sampled, Some("--sampled"))] {
        std::fs::write(&path, text).expect("a file");
        let mut arguments = vec!["modes", path.to_str().expect("a path"), "--phase", "fl closed", "--json"];
        arguments.extend(more);
        let said = program(&arguments).unwrap();
        assert!(said.contains("its sides pull at each other with 5.19 N"), "{said}");
    }
}

/// Laws of a sampled loop that have no linear model at its rest are refused: relays, clocks in them, counters.
#[test]
fn sampled_laws_without_a_linear_model_are_refused() {
    let path = folder("laws").join("model.yaml");
    let loop_of = |memory: &str, events: &str| {
        format!(
            "name: Laws\nparameters: {{m: 1 kg, k: 1 N/m, T: 10 ms, F: 1 N, L: 1 m}}\ncoordinates: {{x: m}}\nmemory: {{{memory}}}\n\
             bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\nsprings: {{s: {{stretch: x, stiffness: k, along: ground.x, on: b}}}}\n\
             forces: {{p: {{on: b, force: \"[u, 0]\"}}}}\nevents:\n{events}\n"
        )
    };
    let law = |law: &str| loop_of("u: 0 N", &format!("  law: {{every: T, then: {{set: {{u: \"{law}\"}}}}}}"));
    let counter = loop_of(
        "u: 0 N, n: 0",
        "  count: {every: T, then: {set: {n: n + 1}}}\n  law: {every: T, if: n - 4.5, then: {set: {u: -k*x, n: 0}}}",
    );
    let said = |text: &str| {
        std::fs::write(&path, text).expect("a file");
        program(&["modes", path.to_str().expect("a path"), "--sampled"])
    };
    for (text, why) in [
        (law("F*sign(x)"), "jumps or turns sharply"),
        (law("-F*abs(x)/L"), "jumps or turns sharply"),
        (law("max(0, -k*x)"), "jumps or turns sharply"),
        (law("-k*x - F*sin(t/T)"), "depends on time"),
        (counter, "acts only where `n` says so"),
    ] {
        let refused = said(&text).unwrap_err();
        assert!(refused.contains(why), "{text}: {refused}");
    }
    assert!(said(&law("-k*x*(1 + x/L)")).unwrap().contains("stability"));
}

/// Two blocks on springs of k = 100 N/m, the lower of which rubs with 2.943 N.
const RUBBED: &str = r#"
name: Rubbed
parameters: {m: 1 kg, k: 100 N/m, mu: 0.3 1, g: 9.81 m/s^2}
coordinates: {x: m, z: m}
bodies: {b: {mass: m, position: "[x, 0]"}, top: {mass: m, position: "[x + z, 0]"}}
springs: {s: {stretch: x, stiffness: k, on: b, along: "[1, 0]"}, q: {stretch: z, stiffness: k, on: top, from: b, along: "[1, 0]"}}
friction: {rub: {rate: x', on: b, along: "[1, 0]", limit: mu*m*g}}
scene: {start: {x: 0.01}, until: 2}
scenes: {far: {start: {x: 0.05}}}
"#;

/// At x = 0.01 m the spring pulls with 1 N of 2.943 N; at 0.05 m with 5 N, so that the block slips, but at rest friction would hold it.
#[test]
fn what_sticks_at_a_rest_is_told_and_what_slips_there_is_refused() {
    let path = folder("rubbed").join("rubbed.yaml");
    std::fs::write(&path, RUBBED).expect("a file");
    let modes = |more: &[&str]| program(&[&["modes", path.to_str().expect("a path")], more].concat());
    let told = modes(&[]).expect("a rest");
    assert!(told.contains("frozen there: rub sticks (takes 0.33978"), "{told}");
    let json: serde_json::Value = serde_json::from_str(&modes(&["--json"]).expect("a rest")).expect("JSON");
    close(json["contacts"]["rub"]["part_of_limit"].as_f64().expect("a part"), 1.0 / 2.943, 1e-9);
    let refused = modes(&["--scene", "far"]).unwrap_err();
    assert!(refused.contains("`rub` slips in this phase, but nothing moves there"), "{refused}");
    // Without friction there is nothing that could hold it.
    assert!(modes(&["--scene", "far", "--set", "mu=0"]).is_ok());
}

/// On a slope at the angle of friction whether it sticks is a matter of the last digits.
#[test]
fn a_rest_at_the_limit_of_friction_is_told() {
    let wedge = |static_: &str| {
        let path = folder("wedge").join("wedge.yaml");
        let text = format!(
            "name: Wedge
parameters: {{m: 1 kg, g: 9.81 m/s^2, mu: 0.3 1, mus: {static_} 1, a: atan(0.3)}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
gravity: g*[sin(a), -cos(a)]
contacts: {{floor: {{gap: y, on: b, normal: \"[0, 1]\", friction: mu, static: mus}}}}
scene: {{start: {{x: 0}}, until: 2}}
"
        );
        std::fs::write(&path, text).expect("a file");
        let told = program(&["modes", path.to_str().expect("a path"), "--json"]).expect("a rest");
        serde_json::from_str::<serde_json::Value>(&told).expect("JSON")["warnings"].to_string()
    };
    assert!(wedge("0.30000003").contains("`floor` (sticks) is on the edge"));
    assert!(!wedge("0.3003").contains("edge"));
}

/// A rod that a motor shortens: no place stays, and that is the reason, not the iterations.
#[test]
fn a_constraint_that_moves_with_time_has_no_rest() {
    let text = "name: Rod\nparameters: {m: 1 kg, l: 1 m, a: 0.2 m, w: 3 rad/s, g: 9.81 m/s^2}\ncoordinates: {x: m, y: m}\n\
                bodies: {bob: {mass: m, position: '[x, y]'}}\ngravity: [0, -g]\n\
                constraints: {rod: 'x^2 + y^2 - (l + a*sin(w*t))^2'}\nscene: {start: {x: 1, y: 0, y': -0.5}, until: 4}\n";
    let found = linearise_constrained(&case(text).system, &Guess::at(&[0.0, -1.0]), false);
    assert!(matches!(&found, Err(LinearError::DependsOnTime { coordinate }) if coordinate == "rod"), "{found:?}");
}

/// Two wheels on an elastic shaft go on together, though the value of neither angle is free: ω² = k (1/J₁ + 1/J₂).
#[test]
fn wheels_that_only_go_on_together_have_a_steady_motion() {
    let text = "name: Gears\nparameters: {J1: 0.1 kg*m^2, J2: 0.4 kg*m^2, k: 1000 N*m/rad, W: 100 rad/s}\ncoordinates: {a: rad, f: rad}\n\
                kinetic_energy: J1*a'^2/2 + J2*f'^2/2\npotential_energy: k*(a - f)^2/2\n\
                scene: {start: {a': W, f': W}, until: 1}\n";
    let path = folder("together").join("gears.yaml");
    std::fs::write(&path, text).expect("written");
    let told = program(&["modes", path.to_str().expect("a path"), "--steady"]).expect("modes");
    assert!(told.contains("111.803"), "{told}");
}

/// A rod whose length is an input that nobody gives: the input is named.
#[test]
fn inputs_that_are_0_are_named_where_nothing_is_found() {
    let text = "name: Rope\nparameters: {m: 1 kg, g: 9.81 m/s^2}\ncoordinates: {x: m, y: m}\ninputs: {L: 1.1 m}\n\
                bodies: {bob: {mass: m, position: '[x, y]'}}\ngravity: [0, -g]\nconstraints: {rope: 'norm([x, y]) - L'}\n\
                scene: {start: {x: 0.1}, guess: {y: -1}, until: 1}\n";
    let path = folder("inputs").join("rope.yaml");
    std::fs::write(&path, text).expect("written");
    let path = path.to_str().expect("a path");
    let refused = program(&["modes", path]).expect_err("no rest");
    assert!(refused.contains("`L` is 0 here") && refused.contains("--input L=1.1"), "{refused}");
    assert!(program(&["modes", path, "--input", "L=1.1"]).is_ok());
}

/// A ball in a bowl swings at √(5 g/(7 (R − r))), and what rounding makes of the real parts grows nowhere.
#[test]
fn growth_whose_sign_rounding_hides_is_not_told() {
    let text = "name: Bowl\nparameters: {m: 1 kg, R: 0.5 m, r: 0.05 m, g: 9.81 m/s^2}\ncoordinates: {x: m, y: m, att: rotation}\n\
                frames: {B: {rotate: att}}\ndefine: {h: 'R - sqrt((R - r)^2 - x^2 - y^2)'}\n\
                points: {C: '[x, y, h]', T: 'C + r*unit(C - [0, 0, R])'}\n\
                bodies: {ball: {mass: m, inertia: [0.4*m*r^2, 0.4*m*r^2, 0.4*m*r^2], frame: B, position: C}}\n\
                gravity: [0, 0, -g]\nconstraints: {roll: 'velocity(ball, T)'}\nscene: {start: {x: 0.1}, until: 5}\n";
    let path = folder("bowl").join("bowl.yaml");
    std::fs::write(&path, text).expect("written");
    let told = program(&["modes", path.to_str().expect("a path")]).expect("modes");
    assert!(told.contains("± 3.94606i") && !told.contains("unstable"), "{told}");
}

/// Bennett's linkage hangs and stands where dV/dth1 = 0, at ±2.50534272 rad, and swings at 4.3513 rad/s (closed form of the linkage, mpmath).  Near
/// other places its five rows, of which two count, seem to carry 10¹⁰ N, beside which any force is small.
#[test]
fn rows_that_depend_on_each_other_hide_no_force() {
    let bennett = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/bennett.yaml");
    let modes = |arguments: &[&str]| {
        let told = program(&[&["modes", bennett, "--json"], arguments].concat()).expect("modes");
        serde_json::from_str::<serde_json::Value>(&told).expect("JSON")
    };
    for (arguments, th1) in [(&[][..], 2.505_342_72), (&["--at", "th1=1"], -2.505_342_72)] {
        let told = modes(arguments);
        let found = told["equilibrium"]["th1"].as_f64().expect("a number");
        assert!((found - th1).abs() < 1e-8, "{found}");
    }
    let told = program(&["modes", bennett, "--at", "th1=1"]).expect("modes");
    assert!(told.contains("omega = 4.3513"), "{told}");
}

/// A tray on three guides of which two hold it: its rest is found, and the guides share its weight as they do in a run, by the least Σ S_kk λ_k².
#[test]
fn what_too_many_guides_hold_rests_and_is_shared_as_in_a_run() {
    let told = printed("modes", "tray", &[]);
    assert!(told.contains("omega = 0.707107"), "{told}");
    for (row, share) in [("p1", "7.11482"), ("p2", "10.3924"), ("p3", "2.11275")] {
        assert!(told.contains(&format!("reaction({row}) at rest = {share} N")), "{told}");
    }
}

/// −c |v| v, whose slope by v is 0 at rest and 0/0 as it is written: a bob on a spring without damping for small motions.  A force of |v| has no slope.
#[test]
fn drag_by_the_square_of_a_speed_damps_no_small_motion() {
    let modes = |force: &str| {
        let text = format!(
            "name: Drag\nparameters: {{m: 1 kg, k: 4 N/m, g: 9.81 m/s^2, c: 0.5 kg/m, d: 0.5 N*s/m}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{b: {{mass: m, position: '[x, y]'}}}}\ngravity: [0, -g]\npoints: {{O: [0, 0]}}\n\
             springs: {{s: {{between: [O, b], stiffness: k}}}}\nforces: {{drag: {{on: b, force: '{force}'}}}}\n\
             scene: {{start: {{x: 0.1}}, until: 1}}\n"
        );
        let path = folder("drag").join("drag.yaml");
        std::fs::write(&path, text).expect("written");
        program(&["modes", path.to_str().expect("a path")])
    };
    let told = modes("-c*norm(velocity(b))*velocity(b)").expect("modes");
    assert!(told.contains("C = 0") && told.contains("omega = 2 rad/s"), "{told}");
    let refused = modes("[-d*norm(velocity(b)), 0]").expect_err("no linear model");
    assert!(refused.contains("not finite"), "{refused}");
}

/// |sin ω t| has a side at any time but 0: no rest, as with sin ω t.
#[test]
fn the_size_of_what_time_moves_is_no_rest() {
    for drive in ["A*abs(sin(w*t))", "A*sin(w*t)", "A*sqrt(abs(w*t))", "-k*x*abs(sin(w*t))"] {
        let text = format!(
            "name: Driven\nparameters: {{m: 1 kg, k: 10 N/m, A: 1 N, w: 3 1/s}}\ncoordinates: {{x: m}}\n\
             bodies: {{cart: {{mass: m, position: '[x, 0]'}}}}\n\
             springs: {{s: {{stretch: x, stiffness: k, on: cart, along: '[1, 0]'}}}}\n\
             forces: {{drive: {{on: cart, force: '[{drive}, 0]'}}}}\nscene: {{start: {{x: 0.1}}, until: 1}}\n"
        );
        let path = folder("driven").join("driven.yaml");
        std::fs::write(&path, text).expect("written");
        let refused = program(&["modes", path.to_str().expect("a path")]).expect_err("no rest");
        assert!(refused.contains("time"), "{drive}: {refused}");
    }
}

/// A bob on a cart that two springs draw along a rail: th comes to 1e-26 rad beside a force of one term, which is nothing but that.
#[test]
fn what_has_one_term_that_vanishes_is_at_rest() {
    let text = "name: Rail\nparameters: {m: 1.19 kg, M: 0.593 kg, l: 0.382 m, g: 9.03 m/s^2, k: 8560 N/m, r: 0.913 m, xa: -1.32 m, \
                ya: 0.61 m, k0: 10 N/m, r0: 1.08 m}\ncoordinates: {x: m, y: m, th: rad}\npoints: {A: '[xa, ya]'}\n\
                bodies: {cart: {mass: M, position: '[x, y]'}, bob: {mass: m, position: '[x + l*sin(th), y - l*cos(th)]'}}\n\
                gravity: [0, -g]\nsprings: {s: {between: [A, cart], stiffness: k, rest: r}, s0: {between: [A, cart], stiffness: k0, rest: r0}}\n\
                constraints: {rail: y}\nscene: {start: {x: 0.165, th: -0.347}, until: 1.55}\n";
    for k0 in [10.0, 20.0, 77.7] {
        let mut case = case(text);
        case.system.set_parameter(9, k0);
        let found = linearise_constrained(&case.system, &Guess::at(&[0.165, 0.0, -0.347]), false);
        assert!(found.is_ok_and(|found| found.linear.equilibrium.q[2] == 0.0), "{k0}");
    }
}
