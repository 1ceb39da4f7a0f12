//! Velocity constraints: integrable in disguise or truly nonholonomic, and the freedoms that they leave (LANGUAGE, section 6).

use dalembert_symbolic::gate::{Freedoms, Integrability};
use dalembert_symbolic::lower::{Program, compile};

use Integrability::{Combined, Integrable, Integral, Nonholonomic, Together};

fn compiled(text: &str) -> Program {
    compile(text, &[]).unwrap_or_else(|problems| {
        let told: Vec<String> =
            problems.iter().map(|problem| format!("{}: {}", problem.code, problem.message)).collect();
        panic!("{text}\n{told:?}")
    })
}

/// A model whose kinetic energy is half the sum of the squares of the speeds.
fn program(coordinates: &str, rest: &str) -> Program {
    let squares: Vec<String> = coordinates.split(' ').map(|name| format!("{name}'^2")).collect();
    let list = coordinates.replace(' ', ": , ");
    compiled(&format!("name: Model\ncoordinates: {{{list}: }}\nkinetic_energy: ({})/2\n{rest}\n", squares.join(" + ")))
}

/// The freedoms of the only phase.
fn freedoms(coordinates: &str, rest: &str) -> Freedoms {
    let program = program(coordinates, rest);
    assert!(program.model.warnings.is_empty(), "{:?}", program.model.warnings);
    let [freedoms] = program.report.freedoms.as_slice() else { panic!("{:?}", program.report.freedoms) };
    assert!(freedoms.decided() && !freedoms.particular, "{freedoms:?}");
    freedoms.clone()
}

#[track_caller]
fn holds(coordinates: &str, rest: &str, (configuration, velocity): (usize, usize), kinds: &[Integrability]) {
    let found = freedoms(coordinates, rest);
    assert_eq!((found.configuration, found.velocity), (configuration, velocity), "{rest}: {found:?}");
    let of: Vec<Integrability> = found.rows.iter().map(|row| row.1).collect();
    assert_eq!(of, kinds, "{rest}");
}

#[test]
fn a_sleigh_has_three_freedoms_of_configuration_and_two_of_velocity() {
    holds("x y th", "constraints: {edge: -sin(th)*x' + cos(th)*y'}", (3, 2), &[Nonholonomic]);
    // Held at an angle it has a groove.
    holds("x y th", "parameters: {a: 0.3}\nconstraints: {edge: -sin(a)*x' + cos(a)*y'}", (2, 2), &[Integral]);
}

/// Inputs are moved as coordinates are, in rows that are rates with them; not where the rate of one stands without its factor.
#[test]
fn rows_with_rates_of_inputs_have_integrals() {
    let with = |row: &str| format!("inputs: {{u: sin(t), w: t^3}}\nconstraints: {{row: \"{row}\"}}");
    for row in ["x' - 0.2*ph' - u'", "u*x' + u'*x - ph'", "x' - u*u' + w' - 2*t", "x' + ph*u*w' + ph*u'*w + ph'*u*w"] {
        holds("x ph", &with(row), (1, 1), &[Integral]);
    }
    // The integral of u itself is not in the file.
    for row in ["x' - 0.2*ph' - u", "x' - w*u'"] {
        holds("x ph", &with(row), (1, 1), &[Integrable]);
    }
}

/// One bracket calls one of two rows integrable.
#[test]
fn an_upright_disc_needs_two_brackets() {
    let rolls = "parameters: {R: 0.5}\nconstraints: {a: x' - R*cos(th)*ph', b: y' - R*sin(th)*ph'}";
    holds("x y th ph", rolls, (4, 2), &[Nonholonomic; 2]);
    // With its heading held it rolls on a line, though neither row is closed.
    let line = "parameters: {R: 0.5}\nconstraints: {a: x' - R*cos(th)*ph', b: y' - R*sin(th)*ph', straight: th'}";
    holds("x y th ph", line, (1, 1), &[Integrable, Integrable, Integral]);
}

#[test]
fn a_tilting_disc_needs_two_brackets() {
    // Heading ψ, tilt θ, spin φ; the point of contact moves with the spin.
    let rolls = "parameters: {R: 0.5}
constraints:
  along: x' - R*(cos(ps)*(ph' + ps'*cos(th)) - th'*sin(ps)*sin(th))
  across: y' - R*(sin(ps)*(ph' + ps'*cos(th)) + th'*cos(ps)*sin(th))";
    holds("x y ps th ph", rolls, (5, 3), &[Nonholonomic; 2]);
}

/// The difference of the wheels' rows is the rate of their turns less the cart's.
#[test]
fn an_integral_is_found_in_a_combination_of_rows() {
    let cart = "parameters: {R: 0.3, b: 0.5}
constraints:
  sideways: -sin(th)*x' + cos(th)*y'
  left: cos(th)*x' + sin(th)*y' - b*th' - R*p'
  right: cos(th)*x' + sin(th)*y' + b*th' - R*q'";
    holds("x y th p q", cart, (4, 2), &[Nonholonomic, Together, Together]);
    let found = freedoms("x y th p q", cart);
    assert_eq!((found.held, found.combinations), (1, 0));
    // Numbers times the rows do no harm; other functions of the state do: it is known to be there, and not written down.
    let scaled = cart.replace("cos(th)*x' + sin(th)*y' - b*th' - R*p'", "3*(cos(th)*x' + sin(th)*y' - b*th' - R*p')/7");
    holds("x y th p q", &scaled, (4, 2), &[Nonholonomic, Together, Together]);
    let hidden = cart.replace("+ b*th' - R*q'", "+ b*th' - R*q' + x*(-sin(th)*x' + cos(th)*y')");
    let found = freedoms("x y th p q", &hidden);
    assert_eq!((found.configuration, found.held, found.combinations), (4, 0, 1));
    assert!(found.rows.iter().any(|row| row.1 == Combined), "{found:?}");
    // Wheels that steer with the cart's heading, of radii that grow with the way: no combination is left.
    let grows = cart.replace("- R*q'", "- R*(1 + x^2)*q'");
    holds("x y th p q", &grows, (5, 2), &[Nonholonomic; 3]);
    assert_eq!(freedoms("x y th p q", &grows).combinations, 0);
}

#[test]
fn a_rolling_cylinder_has_an_integral_also_on_a_belt_that_moves() {
    holds("x ph", "parameters: {R: 0.5}\nconstraints: {rolls: x' - R*ph'}", (1, 1), &[Integral]);
    let belt = "parameters: {R: 0.5, v: 2, w: 3}\nconstraints: {rolls: x' - R*ph' - v*sin(w*t)}";
    holds("x ph", belt, (1, 1), &[Integral]);
    // As an input, whose integral is not known, and times what has none in closed form.
    let input = "parameters: {R: 0.5}\ninputs: {v: 2*sin(3*t)}\nconstraints: {rolls: x' - R*ph' - v}";
    holds("x ph", input, (1, 1), &[Integrable]);
    holds("x ph", &belt.replace("v*sin(w*t)", "v*exp(-t^2)"), (1, 1), &[Integrable]);
    // A belt that moves faster further out moves what stands on it anywhere.
    let wide = "parameters: {v: 2}\nconstraints: {a: x' - v*z}";
    holds("x z", wide, (2, 1), &[Nonholonomic]);
    holds("x z", "parameters: {v: 2}\nconstraints: {a: x' - v*x}", (1, 1), &[Integrable]);
}

/// Closedness is not the test: d(y/x) wants the factor 1/x².
#[test]
fn an_integrating_factor_leaves_a_row_integrable() {
    holds("x y z", "constraints: {a: y*x' - x*y'}", (2, 2), &[Integrable]);
    holds("x y z", "constraints: {a: y*x' + x*y'}", (2, 2), &[Integral]);
    holds("x y z", "constraints: {a: y*x' - x*y' + z'}", (3, 2), &[Nonholonomic]);
    holds("x y z", "constraints: {a: z*(y*x' + x*y' - z')}", (2, 2), &[Integrable]);
}

/// A bracket that is zero but for rounding is none: scaled to length 1 it would make two rods nonholonomic.
#[test]
fn two_rods_written_with_velocities_are_holonomic() {
    let rods = "constraints: {one: x*x' + y*y', two: (u - x)*(u' - x') + (w - y)*(w' - y')}";
    holds("x y u w", rods, (2, 2), &[Integral; 2]);
    let factors = "constraints:
  one: (x*x' + y*y')*(2 + sin(u))
  two: ((u - x)*(u' - x') + (w - y)*(w' - y'))*(3 + x^2)";
    holds("x y u w", factors, (2, 2), &[Integrable; 2]);
    let mixed = "constraints:
  one: x*x' + y*y' + sin(u)*((u - x)*(u' - x') + (w - y)*(w' - y'))
  two: (u - x)*(u' - x') + (w - y)*(w' - y')";
    holds("x y u w", mixed, (2, 2), &[Integrable, Integral]);
}

#[test]
fn a_weak_row_stays_nonholonomic_and_units_do_not_matter() {
    for epsilon in ["1e-6", "1e-12", "1", "1e9"] {
        let weak = format!("parameters: {{e: {epsilon}}}\nconstraints: {{edge: -e*sin(th)*x' + y'}}");
        holds("x y th", &weak, (3, 2), &[Nonholonomic]);
    }
    let nearly = "parameters: {e: 1e-6}\nconstraints: {edge: -(1 + e*sin(th))*x' + y'}";
    holds("x y th", nearly, (3, 2), &[Nonholonomic]);
}

#[test]
fn holonomic_constraints_are_taken_off_both_counts() {
    let slope = "constraints: {edge: -sin(th)*x' + cos(th)*y', ramp: z - x/2}";
    holds("x y z th", slope, (3, 2), &[Nonholonomic]);
    holds("x y", "parameters: {l: 2}\nconstraints: {rod: x^2 + y^2 - l^2}", (1, 1), &[]);
    // On a line the edge lets a skate turn and not pass, except where it points along the line.
    let line = "constraints: {edge: -sin(th)*x' + cos(th)*y', line: y - 2*x}";
    holds("x y th", line, (1, 1), &[Integrable]);
}

#[test]
fn constraints_that_leave_no_velocity_are_counted() {
    holds("x y", "constraints: {a: x' - 2*t, b: y'}", (0, 0), &[Integral; 2]);
    holds("x y", "constraints: {a: x - sin(t), b: y}", (0, 0), &[]);
}

/// Two rows neither of which is a rate, and their sum; three of which two combinations are.
#[test]
fn integrals_of_combinations_are_written_down() {
    holds("x y z w", "constraints: {a: x' - y*w', b: y*w' - z'}", (3, 2), &[Together; 2]);
    holds("x y z w", "constraints: {a: \"[x' - y*w', z' - y*w']\"}", (3, 2), &[Together; 2]);
    let three = "constraints: {a: x' - y*w', b: 2*y*w' - z', c: u' + y*w'/3 - t}";
    holds("x y z u w", three, (3, 2), &[Together; 3]);
    assert_eq!(freedoms("x y z u w", three).held, 2);
    // In another phase the other row is not there.
    let apart = "constraints: {a: x' - y*w', b: y*w' - z'}\nphases: {one: [a, b], other: [a]}";
    let program = program("x y z w", apart);
    let kinds: Vec<Integrability> = program.report.freedoms[0].rows.iter().map(|row| row.1).collect();
    assert_eq!(kinds, [Combined; 2]);
}

/// Coordinates that have nothing to do with each other are decided apart.
#[test]
fn kinds_are_told_row_by_row() {
    let all = "parameters: {R: 0.5, l: 2}
constraints: {edge: -sin(th)*x' + cos(th)*y', rolls: u' - R*ph', rod: p^2 + q^2 - l^2, factor: w*r' - r*w'}";
    holds("x y th u ph p q r w", all, (6, 5), &[Nonholonomic, Integral, Integrable]);
}

/// A closed row's integral, in words.
#[test]
fn integrals_are_written_down() {
    let integral = |coordinates: &str, rest: &str| {
        let program = program(coordinates, rest);
        let derivation = dalembert_symbolic::derive::derive(program.model.clone()).expect("derives");
        derivation
            .rows
            .integral
            .iter()
            .map(|i| i.map(|i| dalembert_symbolic::model::text(&derivation.model, i)))
            .collect::<Vec<_>>()
    };
    let one = |coordinates: &str, row: &str| {
        integral(coordinates, &format!("parameters: {{R: 0.5, v: 2}}\nconstraints: {{a: \"{row}\"}}")).remove(0)
    };
    assert_eq!(one("x ph", "x' - R*ph'").as_deref(), Some("x - R*ph"));
    for (row, closed) in [
        ("x' - R*ph' - v*t", true),
        ("x*x' + ph*ph'", true),
        ("cos(ph)*x' - x*sin(ph)*ph'", true),
        ("sin(ph)*cos(ph)*ph' + x'", true),
        ("x'/sqrt(1 + x) + exp(2*ph)*ph'", true),
        ("2*x*ph*x' + x^2*ph' + 3*(1 + x)^4*x'", true),
        ("cos(x + 2*ph)*(x' + 2*ph')", true),
        ("cosh(x)*x' + sqrt(3 + ph)*ph'", true),
        ("cos(ph)*x' + x*sin(ph)*ph'", false),
        ("ph*x' - x*ph'", false),
        ("exp(x^2)*x' + ph'", false),
        ("x' + atan(ph)*ph'", false),
    ] {
        assert_eq!(one("x ph", row).is_some(), closed, "{row}: {:?}", one("x ph", row));
    }
}

/// What is warned of, as (message, help).
fn warned(program: &Program) -> Vec<(&str, &str)> {
    program.model.warnings.iter().map(|w| (w.message.as_str(), w.help.as_str())).collect()
}

/// Exactly the rows in a combination that vanishes have reactions that are not unique.
#[test]
fn the_warning_names_the_reactions_that_are_not_unique() {
    let found = program(
        "x y z u",
        "parameters: {l: 2}
constraints: {rod: x^2 + y^2 - l^2, wall: z, again: 2*x^2 + 2*y^2 - 2*l^2, spins: u', z_too: 3*z + 0.001*u}",
    );
    let help =
        |list: &str| format!("leave it out; the run goes on with it, but the reactions of {list} are not unique");
    let told = warned(&found);
    assert_eq!(told.len(), 2, "{told:?}");
    assert_eq!(told[0], ("`again` follows from the constraints before it", help("`rod` and `again`").as_str()));
    // A row of another unit, and weak beside the first.
    assert_eq!(
        told[1],
        ("`z_too` follows from the constraints before it", help("`wall`, `spins` and `z_too`").as_str())
    );
    assert_eq!(found.report.ranks, [3]);
    assert_eq!((found.report.freedoms[0].configuration, found.report.freedoms[0].velocity), (1, 1));
    // A sum of two rows, one of which another phase leaves out.
    let phases = program(
        "x y z",
        "constraints: {a: x, b: y, both: x + y}\nphases: {all: [a, b, both], two: [a, both], other: [both, b]}",
    );
    assert_eq!(
        warned(&phases),
        [("`both` follows from the constraints before it of the phase `all`", help("`a`, `b` and `both`").as_str())]
    );
    assert_eq!(phases.report.ranks, [2, 2, 2]);
}

/// Three cranks on one coupler: it turns only where it is a parallelogram.
const CRANKS: &str = "
name: Cranks
parameters: {r: 1 m, s: 1 m, u: 1 m, c: 2 m, d: 3 m, base: 2 m, far: 3 m, m: 1 kg}
coordinates: {a: rad, p: rad, q: rad, k: rad}
points:
  first: \"r*[cos(a), sin(a)]\"
  second: \"[base, 0] + s*[cos(p), sin(p)]\"
  third: \"[far, 0] + u*[cos(q), sin(q)]\"
bodies: {bar: {mass: m, inertia: m*c^2, angle: k, position: first}, one: {mass: m, position: second}, two: {mass: m, position: third}}
constraints: {near: first + c*bar.x - second, end: first + d*bar.x - third}
scene: {start: {a: 1}, guess: {p: 1, q: 1, k: 0}}
";

#[test]
fn what_is_redundant_for_the_scenes_lengths_only_is_decided_there() {
    let found = compiled(CRANKS);
    let told = warned(&found);
    let [(message, help)] = told.as_slice() else { panic!("{told:?}") };
    assert_eq!(*message, "`end.y` follows from the constraints before it for these values of the parameters");
    assert!(help.contains("`near.x`, `near.y`, `end.x` and `end.y`"), "{help}");
    assert_eq!(found.report.ranks, [3]);
    let freedoms = &found.report.freedoms[0];
    assert_eq!((freedoms.configuration, freedoms.velocity, freedoms.particular), (1, 1, true), "{freedoms:?}");
    // Two cranks of a length and a third that is longer hold the coupler: four rows are independent.
    let held = compiled(&CRANKS.replace("u: 1 m", "u: 1.3 m"));
    assert_eq!(held.report.ranks, [4]);
    let freedoms = &held.report.freedoms[0];
    assert_eq!((freedoms.configuration, freedoms.velocity, freedoms.particular), (0, 0, false), "{freedoms:?}");
    // The same where a scene's own value makes it turn.
    let scene = CRANKS.replace("u: 1 m", "u: 1.3 m").replace("scene: {", "scene: {set: {u: 1}, ");
    assert_eq!(compiled(&scene).report.ranks, [3]);
}

/// What is integrable only where a parameter is what the file says.
#[test]
fn integrability_is_decided_at_the_files_parameters() {
    let at = |c: &str| {
        let file = format!("parameters: {{c: {c}}}\nconstraints: {{edge: -(1 + c*sin(th))*x' + z*y'*0 + y'}}");
        program("x y z th", &file).report.freedoms[0].clone()
    };
    let found = at("0");
    assert_eq!(found.rows[0].1, Integrable);
    assert!(found.particular && found.configuration == 3, "{found:?}");
    let found = at("0.5");
    assert_eq!(found.rows[0].1, Nonholonomic);
    assert!(!found.particular && found.configuration == 4, "{found:?}");
}

/// A car with trailers: each more takes one more bracket.
fn trailers(count: usize) -> Program {
    let headings: Vec<String> = (0..count).map(|k| format!("h{k}")).collect();
    let mut rows = vec!["a0: -sin(h0)*x' + cos(h0)*y'".to_owned()];
    let (mut x, mut y) = ("x'".to_owned(), "y'".to_owned());
    for k in 1..count {
        x.push_str(&format!(" + sin(h{k})*h{k}'"));
        y.push_str(&format!(" - cos(h{k})*h{k}'"));
        rows.push(format!("a{k}: -sin(h{k})*({x}) + cos(h{k})*({y})"));
    }
    program(&format!("x y {}", headings.join(" ")), &format!("constraints:\n  {}", rows.join("\n  ")))
}

#[test]
fn work_is_bounded_and_what_was_not_decided_is_said() {
    for count in [2, 3, 4] {
        let found = trailers(count).report.freedoms.remove(0);
        assert_eq!((found.configuration, found.velocity, found.decided()), (count + 2, 2, true), "{found:?}");
        assert!(found.rows.iter().all(|row| row.1 == Nonholonomic), "{found:?}");
    }
    let found = trailers(14).report.freedoms.remove(0);
    assert!(!found.decided() && found.velocity == 2 && (2..=16).contains(&found.configuration), "{found:?}");
}

/// A motor's current is no freedom of what it moves.
#[test]
fn states_of_first_order_are_no_freedoms() {
    let wheel = "states: {i: -i - ph', z: x}\nconstraints: {roll: x' - ph'}";
    holds("x ph", wheel, (1, 1), &[Integral]);
}

/// One row of a joint is not to be left out alone.
#[test]
fn joints_that_hold_what_is_held_are_not_told_to_go() {
    let text = "name: Jack\nparameters: {m: 10 kg, J: 0.02 kg*m^2, h: 5 mm}\ncoordinates: {z: m, th: rad}\n\
                frames: {N: {rotate: [z, th]}}\npoints: {C: '[0, 0, z]'}\n\
                bodies: {nut: {mass: m, inertia: [J, J, J], frame: N, position: C}}\n\
                joints: {screw: {screw: [ground, nut], at: ['[0, 0, 0]', C], axis: [ground.z, nut.z], pitch: h}}\n";
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
    let told = warned(&program);
    let meant = |help: &str| help.starts_with("its coordinates or other joints hold this already;");
    assert!(!told.is_empty() && told.iter().all(|(_, help)| meant(help)), "{told:?}");
}
