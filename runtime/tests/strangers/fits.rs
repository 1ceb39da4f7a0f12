//! Records that motions do not follow closely.

use super::{folder, program};

const OSCILLATOR: &str = "name: F\nparameters: {m: 1 kg, k: 3.5 N/m, c: 0.3 N*s/m}\ncoordinates: {x: m}\n\
    kinetic_energy: m*x'^2/2\npotential_energy: k*x^2/2\ngeneralized_forces: {x: -c*x'}\nscene: {start: {x: 0.1}, until: 4}\n";
/// Mostly noise.
const NOISY: &str = "t,x\n0.0,0.106\n0.25,0.155\n0.5,-0.018\n0.75,0.060\n1.0,0.101\n1.25,-0.009\n1.5,0.149\n1.75,-0.212\n2.0,-0.044\n\
    2.25,-0.123\n2.5,-0.096\n2.75,0.026\n3.0,0.104\n3.25,0.134\n3.5,0.130\n3.75,0.359\n";
/// Of it, to 16 digits, by the closed form of the motion: k, c and the start; their standard errors; the standard deviation.
const FOUND: [f64; 3] = [2.712_626_689_577_403, -1.259_527_285_235_03, 0.026_223_664_168_016_76];
const SPREAD: [f64; 4] = [0.351_703_765_81, 0.637_701_025_076, 0.029_104_647_548_3, 0.098_865_012_309_8];

/// What is found from a record at a tolerance.
fn fitted(record: &str, tolerance: &str) -> String {
    let folder = folder("fits");
    let (model, table) = (folder.join("f.yaml"), folder.join(format!("{}-{tolerance}.csv", record.len())));
    std::fs::write(&model, OSCILLATOR).expect("a file");
    std::fs::write(&table, record).expect("a file");
    let [model, table] = [&model, &table].map(|path| path.to_str().expect("a path"));
    let unknown = ["--unknown", "k=4.2,c=0.1,x=0.12", "--tolerance", tolerance];
    program(&[&["solve", model, "--fit", table], &unknown[..]].concat()).unwrap()
}

/// A table with semicolons is read as in `motions`.
#[test]
fn records_with_semicolons_were_refused() {
    assert_eq!(fitted(&NOISY.replace(',', " ; "), "1e-9"), fitted(NOISY, "1e-9"));
}

/// A fit is drawn with the 16 points of its record and, below, as many residuals.
#[test]
fn fits_were_not_drawn() {
    let folder = folder("fits");
    let [model, table, chart] = ["drawn.yaml", "drawn.csv", "drawn.svg"].map(|name| folder.join(name));
    std::fs::write(&model, OSCILLATOR).expect("a file");
    std::fs::write(&table, NOISY).expect("a file");
    let [model, table, plot] = [&model, &table, &chart].map(|path| path.to_str().expect("a path"));
    program(&["solve", model, "--fit", table, "--unknown", "k=4.2,c=0.1,x=0.12", "--plot", plot]).unwrap();
    let svg = std::fs::read_to_string(chart).expect("a chart");
    assert!(
        svg.contains("residual of x") && svg.matches("<polygon").count() >= 32,
        "{}",
        svg.matches("<polygon").count()
    );
}

/// True where a number that is printed is the exact one to its last digit.
fn holds(printed: &str, exact: f64) -> bool {
    let places = printed.split('.').nth(1).map_or(0, |decimals| decimals.len() as i32);
    (printed.parse::<f64>().expect("a number") - exact).abs() <= 10.0_f64.powi(-places)
}

#[test]
fn fits_with_large_residuals_have_the_digits_that_are_printed() {
    for tolerance in ["1e-5", "1e-7", "1e-9", "1e-12"] {
        let text = fitted(NOISY, tolerance);
        for (name, (exact, spread)) in ["k", "c", "x"].into_iter().zip(FOUND.into_iter().zip(SPREAD)) {
            let start = format!("  {name} = ");
            let line = text.lines().find_map(|line| line.strip_prefix(&start)).expect("a line");
            let words: Vec<&str> = line.split([' ', ',']).collect();
            let error = words.iter().position(|word| *word == "error").expect("a standard error");
            assert!(words[0].len() >= 10 && holds(words[0], exact), "{tolerance}: {name} = {}, not {exact}", words[0]);
            assert!(words[error + 1].len() >= 7 && holds(words[error + 1], spread), "{tolerance}: {line}, {spread}");
        }
        assert!(text.contains("standard deviation 0.098865 m"), "{text}");
    }
}

#[test]
fn fits_without_residuals_keep_their_digits() {
    let (k, c) = (4.0_f64, 0.2_f64);
    let (d, w) = (0.5 * c, (k - 0.25 * c * c).sqrt());
    let x = |t: f64| 0.1 * (-d * t).exp() * ((w * t).cos() + d / w * (w * t).sin());
    let rows = (0..16).map(|i| 0.25 * f64::from(i)).map(|t| format!("{t},{:?}\n", x(t)));
    let text = fitted(&format!("t,x\n{}", rows.collect::<String>()), "1e-9");
    let found = text.lines().find_map(|line| line.strip_prefix("  k = ")).expect("a line");
    let found = found.split(' ').next().expect("a number");
    assert!(found.len() >= 10 && holds(found, k), "{text}");
    // What is left is rounding, which tells nothing of a record.
    assert!(text.contains("standard error ?, 95 % within ?"), "{text}");
}

/// A record of x'' = −k x − c x' from x = 0.1 at rest determines all four.
#[test]
fn unknowns_whose_best_value_is_0_were_refused() {
    let (k, c) = (4.0_f64, 0.2_f64);
    let (d, w) = (0.5 * c, (k - 0.25 * c * c).sqrt());
    let x = |t: f64| 0.1 * (-d * t).exp() * ((w * t).cos() + d / w * (w * t).sin());
    let rows = (0..16).map(|i| 0.25 * f64::from(i)).map(|t| format!("{t},{:?}\n", x(t)));
    let folder = folder("fits");
    let [model, scaled, table] = ["rest.yaml", "scaled.yaml", "rest.csv"].map(|name| folder.join(name));
    std::fs::write(&model, OSCILLATOR).expect("a file");
    let by_mass = OSCILLATOR.replace("3.5 N/m", "3.5 1/s^2").replace("0.3 N*s/m", "0.3 1/s");
    std::fs::write(&scaled, by_mass.replace("k*x^2/2", "m*k*x^2/2").replace("-c*x'", "-m*c*x'")).expect("a file");
    std::fs::write(&table, format!("t,x\n{}", rows.collect::<String>())).expect("a file");
    let [model, scaled, table] = [&model, &scaled, &table].map(|path| path.to_str().expect("a path"));
    for guess in ["0", "0.05", "-0.01"] {
        let unknown = format!("k=3.6,c=0.1,x=0.12,x'={guess}");
        let told = program(&["solve", model, "--fit", table, "--unknown", &unknown]).expect("a fit");
        let value = |name: &str| -> f64 {
            let line = told.lines().find_map(|line| line.strip_prefix(&format!("  {name} = "))).expect("a line");
            line.split(' ').next().expect("a number").parse().expect("a number")
        };
        assert!((value("k") - k).abs() < 1e-8 && value("x'").abs() < 1e-8, "{told}");
    }
    // A mass that nothing depends on is not told by a record, however near 0 another unknown is.
    let unknown = "k=3.6,c=0.1,x=0.12,x'=0,m=1";
    let refused = program(&["solve", scaled, "--fit", table, "--unknown", unknown]).expect_err("a refusal");
    assert!(refused.contains("does not tell the unknowns apart") && refused.contains("m by 1.0000"), "{refused}");
}

/// x = F t²/(2 m): what is missed is measured alike before and after a step, whatever the motion makes of it, so that steps are no worse than they are.
#[test]
fn values_far_below_those_of_the_guess_were_not_found() {
    let path = folder("fits").join("pushed.yaml");
    let text = "name: P\nparameters: {m: 1 kg, F: 1 N}\ncoordinates: {x: m}\nkinetic_energy: m*x'^2/2\ngeneralized_forces: {x: F}\n\
        scene: {start: {x: 0}, until: 1}\n";
    std::fs::write(&path, text).expect("a file");
    let solved = |unknown: &str, wanted: &str| {
        let path = path.to_str().expect("a path");
        program(&["solve", path, "--unknown", unknown, "--such-that", wanted]).expect("a solution")
    };
    for (x, m) in [(0.24, "m = 2.08333333333"), (0.1, "m = 5.0000000000"), (1e-3, "m = 500.00000000")] {
        let told = solved("m=1", &format!("x={x}"));
        assert!(told.contains(m), "{told}");
    }
    for (x, until) in [("1e6", "until = 1414.21356237"), ("1e-6", "until = 0.00141421356237")] {
        let told = solved("until=1", &format!("x={x}"));
        assert!(told.contains(until), "{told}");
    }
}
