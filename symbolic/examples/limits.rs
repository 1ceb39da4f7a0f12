//! Prints `docs/limits.md`: the slowest legal file of each kind, and what the first file beyond the limit is told.
//!
//! Each is derived in a process of its own, whose largest memory is asked of the system (Linux; elsewhere a dash).

use std::fmt::Write;
use std::process::Command;
use std::time::Instant;

use dalembert_symbolic::lower::compile;
use dalembert_symbolic::print;

/// A kind of file: what it is full of, the size of the largest legal one, one that is not, its text.
type Kind = (&'static str, usize, usize, fn(usize) -> String);

const KINDS: [Kind; 22] = [
    ("bodies, by running sums of one coordinate", 40_000, 99_000, running_sums),
    ("bodies, by running sums of different terms", 1_500, 40_000, running_terms),
    ("particles that move by themselves", 2_000, 2_001, free),
    ("coordinates that M couples with each other", 400, 401, telescope),
    ("links of a chain of pendulums", 100, 250, chain),
    ("springs, one between every two of so many bodies", 100, 400, springs),
    ("forces on one body", 20_000, 100_000, forces),
    ("discontinuities beside each other", 1_000, 1_001, switches),
    ("the same as one sum", 1_000, 100_000, absolutes),
    ("discontinuities inside each other", 1_000, 1_001, nested),
    ("definitions by the square of the one before", 200, 100_001, squares),
    ("systems of balances", 1_000, 9_000, systems),
    ("balances of one system", 400, 401, balances),
    ("numbers in a table", 99_000, 100_000, table),
    ("conserved quantities, and as many outputs", 20_000, 60_000, watched),
    ("events", 20_000, 100_000, events),
    ("factors of a product, in characters of 65 536", 4_700, 4_800, product),
    ("links of a chain in Cartesian coordinates, held by constraints", 133, 134, rods),
    ("phases, with a claim in the last", 1_000, 100_000, phases),
    ("links of a chain in space, by two angles each", 40, 80, links_in_space),
    ("charges on a sphere, a spring between every two", 60, 400, charges),
    ("peaks in an integral, by a rule of quadrature", 1, 10, peaks),
];

fn main() {
    if let Some(place) = std::env::args().nth(1).and_then(|place| place.parse::<usize>().ok()) {
        return measured(place);
    }
    println!("# The slowest legal files\n");
    println!(
        "Reading, deriving, judging, lowering and printing the largest file of each kind that is within the limits (those of \
         the language, and a million nodes of the expression graph), on one core, optimised; and the next larger one, which \
         is refused (an empty last column: it is legal too). Regenerate: `cargo run --release --example limits -p dalembert-symbolic > docs/limits.md`. Seconds \
         depend on the machine; what must not happen is that any of them grows beyond all measure.\n"
    );
    println!("| full of | how many | seconds | megabytes | refused | after seconds | with |");
    println!("| --- | ---: | ---: | ---: | ---: | ---: | --- |");
    for place in 0..KINDS.len() {
        let this = std::env::current_exe().unwrap_or_default();
        let output = Command::new(this).arg(place.to_string()).output();
        let line = output.map_or_else(
            |error| error.to_string(),
            |output| String::from_utf8_lossy(&output.stdout).trim_end().to_owned(),
        );
        println!("{line}");
    }
}

/// One line of the table.
fn measured(place: usize) {
    let (words, legal, beyond, text) = KINDS[place];
    let (told, seconds) = derived(&text(legal));
    let told = if told.is_empty() { String::new() } else { format!(" ({told})") };
    let memory = peak().map_or_else(|| "–".to_owned(), |kilobytes| (kilobytes / 1024).to_string());
    let (code, after) = derived(&text(beyond));
    println!("| {words} | {legal}{told} | {seconds:.1} | {memory} | {beyond} | {after:.1} | {code} |");
}

/// The first error's code and place, empty where there is none, and how long it took.
fn derived(text: &str) -> (String, f64) {
    let start = Instant::now();
    let code = match compile(text, &[]) {
        Ok(program) => {
            // What is printed counts too.
            let printed = print::rust(&program, text, "Large");
            if printed.is_empty() { "nothing printed".to_owned() } else { String::new() }
        }
        Err(problems) => {
            let place = dalembert_symbolic::file::locate(text, &[&problems[0].place])[0].start;
            format!("{} in line {}", problems[0].code, text[..place].matches('\n').count() + 1)
        }
    };
    (code, start.elapsed().as_secs_f64())
}

/// The largest memory of this process so far, in kB.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches("kB").trim().parse().ok()
}

/// A file with one coordinate x and these further lines.
fn one(n: usize, lines: &str) -> String {
    format!(
        "name: Large\nsizes: {{n: {n}}}\nparameters: {{m: 1 kg, k: 1 N/m, d: 1 m, F: 1 N}}\ncoordinates: {{x: m}}\n{lines}"
    )
}

/// The same with a body at x.
fn bead(n: usize, lines: &str) -> String {
    one(n, &format!("bodies: {{bead: {{mass: m, position: \"[x, 0]\"}}}}\n{lines}"))
}

/// A file with n coordinates.
fn many(n: usize, lines: &str) -> String {
    format!(
        "name: Large\nsizes: {{n: {n}}}\nparameters: {{m: 1 kg, k: 1 N/m, d: 1 m, g: 9.81 m/s^2}}\n\
         coordinates: {{\"q[i in 1..n]\": m}}\n{lines}"
    )
}

fn running_sums(n: usize) -> String {
    running(n, "x/i")
}

fn running_terms(n: usize) -> String {
    running(n, "d*sin(x/(i*d))")
}

fn running(n: usize, term: &str) -> String {
    one(
        n,
        &format!(
            "define: {{\"s[0]\": 0*d, \"s[i in 1..n]\": \"s[i-1] + {term}\"}}\n\
             bodies: {{\"b[i in 1..n]\": {{mass: m, position: \"[s[i], 0]\"}}}}\n"
        ),
    )
}

fn free(n: usize) -> String {
    many(n, "bodies: {\"b[i in 1..n]\": {mass: m, position: \"[q[i], 0]\"}}\n")
}

fn telescope(n: usize) -> String {
    many(
        n,
        "define: {\"s[0]\": 0*d, \"s[i in 1..n]\": \"s[i-1] + q[i]\"}\n\
         bodies: {\"b[i in 1..n]\": {mass: m, position: \"[s[i], 0]\"}}\n",
    )
}

fn chain(n: usize) -> String {
    many(
        n,
        "points: {\"p[0]\": \"[0*d, 0*d]\", \"p[i in 1..n]\": \"p[i-1] + d*[sin(q[i]/d), -cos(q[i]/d)]\"}\n\
         bodies: {\"b[i in 1..n]\": {mass: m, position: \"p[i]\"}}\ngravity: \"[0, -g]\"\n",
    )
}

fn springs(n: usize) -> String {
    many(
        n,
        "bodies: {\"b[i in 1..n]\": {mass: m, position: \"[q[i], i*d]\"}}\n\
         springs: {\"s[i in 1..n, j in i+1..n]\": {between: [\"b[i]\", \"b[j]\"], stiffness: k, rest: d}}\n",
    )
}

fn forces(n: usize) -> String {
    bead(n, "forces: {\"f[i in 1..n]\": {on: bead, force: \"[F*cos(x/(i*d)), 0]\"}}\n")
}

fn switches(n: usize) -> String {
    bead(n, "forces: {\"f[i in 1..n]\": {on: bead, force: \"[-F*step(x - i*d), 0]\"}}\n")
}

fn absolutes(n: usize) -> String {
    bead(n, "potential_energy: \"F*sum(abs(x - i*d), i in 1..n)\"\n")
}

fn nested(n: usize) -> String {
    bead(n, "define: {\"s[0]\": x, \"s[i in 1..n]\": \"abs(s[i-1] - d/(i+1))\"}\npotential_energy: \"F*s[n]\"\n")
}

fn squares(n: usize) -> String {
    bead(n, "define: {\"s[0]\": x/d, \"s[i in 1..n]\": \"sin(s[i-1])*s[i-1]\"}\npotential_energy: \"F*d*s[n]\"\n")
}

fn systems(n: usize) -> String {
    let mut text = bead(n, "balances:\n");
    for k in 0..n {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  s{k}: {{equations: [{{force: {{of: [bead], along: \"[1, 0]\"}}}}]}}");
    }
    text
}

fn balances(n: usize) -> String {
    many(
        n,
        "bodies: {\"b[i in 1..n]\": {mass: m, position: \"[q[i], 0]\"}}\n\
         balances: {equations: {\"e[i in 1..n]\": {force: {of: [\"b[i]\"], along: \"[1, 0]\"}}}}\n",
    )
}

fn table(n: usize) -> String {
    let numbers: Vec<String> = (0..n).map(|k| (k % 97 + 1).to_string()).collect();
    format!(
        "name: Large\nsizes: {{n: {n}}}\nparameters: {{m: 1, \"k[i in 1..n]\": [{}]}}\ncoordinates: {{x: 1}}\n\
         kinetic_energy: m*x'^2/2\npotential_energy: \"sum(k[i]*x^2, i in 1..n)\"\n",
        numbers.join(", ")
    )
}

fn watched(n: usize) -> String {
    bead(n, "conserved: {\"p[i in 1..n]\": \"i*m*x'\"}\noutputs: {\"o[i in 1..n]\": \"x/i\"}\n")
}

fn events(n: usize) -> String {
    bead(n, "events: {\"e[i in 1..n]\": {when: \"sin(x/d) - i/n\", then: record}}\n")
}

fn product(n: usize) -> String {
    let factors: Vec<String> = (0..n).map(|k| format!("cos(x/d/{k})").replace("/0)", ")")).collect();
    bead(n, &format!("potential_energy: \"F*d*{}\"\n", factors.join("*")))
}

fn rods(n: usize) -> String {
    format!(
        "name: Large\nsizes: {{n: {n}}}\nparameters: {{m: 1 kg, d: 1 m, g: 9.81 m/s^2}}\n\
         coordinates: {{\"x[i in 1..n]\": m, \"y[i in 1..n]\": m}}\n\
         points: {{\"p[0]\": \"[0*d, 0*d]\", \"p[i in 1..n]\": \"[x[i], y[i]]\"}}\n\
         bodies: {{\"b[i in 1..n]\": {{mass: m, position: \"p[i]\"}}}}\ngravity: \"[0, -g]\"\n\
         constraints: {{\"rod[i in 1..n]\": \"dot(p[i] - p[i-1], p[i] - p[i-1]) - d^2\"}}\n\
         scene: {{start: {{\"x[i in 1..n]\": \"i*d\", \"y[i in 1..n]\": 0}}}}\n"
    )
}

fn links_in_space(n: usize) -> String {
    format!(
        "name: Large\nsizes: {{n: {n}}}\nparameters: {{m: 1 kg, l: 1 m, g: 10 m/s^2}}\n\
         coordinates: {{\"a[i in 1..n]\": rad, \"b[i in 1..n]\": rad}}\npoints:\n  \"p[0]\": \"[0, 0, 0]\"\n  \"p[i in 1..n]\": \
         \"p[i-1] + l*[sin(a[i])*cos(b[i]), sin(a[i])*sin(b[i]), -cos(a[i])]\"\n\
         bodies: {{\"k[i in 1..n]\": {{mass: m, position: \"p[i]\"}}}}\ngravity: [0, 0, -g]\nconserved: {{energy: energy}}\n\
         scene: {{start: {{\"a[i in 1..n]\": 0.5}}, until: 1}}\n"
    )
}

fn charges(n: usize) -> String {
    // Around the equator they are apart from each other.
    format!(
        "name: Large\nsizes: {{n: {n}}}\nparameters: {{m: 1, k: 1}}\n\
         coordinates: {{\"x[i in 1..n]\": 1, \"y[i in 1..n]\": 1, \"z[i in 1..n]\": 1}}\n\
         bodies: {{\"p[i in 1..n]\": {{mass: m, position: \"[x[i], y[i], z[i]]\"}}}}\n\
         springs: {{\"s[i in 1..n, j in i+1..n]\": {{between: [\"p[i]\", \"p[j]\"], energy: \"-k*ln(length)\"}}}}\n\
         constraints: {{\"on[i in 1..n]\": \"x[i]^2 + y[i]^2 + z[i]^2 - 1\"}}\n\
         scene: {{start: {{\"x[i in 1..n]\": \"cos(2*pi*i/n)\", \"y[i in 1..n]\": \"sin(2*pi*i/n)\", \"z[i in 1..n]\": 0}}, until: 10}}\n"
    )
}

fn peaks(n: usize) -> String {
    let peak = |k: usize| format!("integral(F/sqrt(1 + ((y - 0.{k}173*d)/s)^2), y in 0..d)*x/d");
    let sum: Vec<String> = (1..=n).map(peak).collect();
    bead(n, &format!("potential_energy: {}\n", sum.join(" + "))).replace("d: 1 m", "d: 1 m, s: 1e-3 m")
}

fn phases(n: usize) -> String {
    let phases: Vec<String> = (0..n).map(|k| format!("p{k}: [{}]", ["floor", ""][k % 2])).collect();
    let last = n - 1;
    bead(n, "").replace("x: m}", "x: m, y: m}").replace("[x, 0]", "[x, y]")
        + &format!(
            "constraints: {{floor: y}}\nphases: {{{}}}\nconserved: {{a: {{value: energy, phase: p{last}}}}}\n",
            phases.join(", ")
        )
}
