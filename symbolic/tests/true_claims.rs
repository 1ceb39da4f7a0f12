//! Claims that are true are accepted, at every scale; claims that are nearly true are refused.

use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;

/// Marsaglia's xorshift (Journal of Statistical Software 8, 2003).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A size between 1e-12 and 1e12, in three digits.
    fn size(&mut self) -> f64 {
        let x = 10_f64.powf(24.0 * self.next() - 12.0);
        format!("{x:.2e}").parse().expect("a number")
    }
}

/// Scales of one model: mass, length, stiffness, time.
struct Sizes {
    m: f64,
    l: f64,
    k: f64,
    t: f64,
}

impl Sizes {
    fn new(numbers: &mut Numbers) -> Sizes {
        Sizes { m: numbers.size(), l: numbers.size(), k: numbers.size(), t: numbers.size() }
    }
}

/// A mass on a spring in the plane, in Cartesian coordinates.
fn cartesian(s: &Sizes, claims: &str) -> String {
    let Sizes { m, l, k, t } = s;
    let speed = l / t;
    format!(
        "name: Cartesian
parameters: {{m: {m:e} kg, k: {k:e} N/m, d: {l:e} m, e: {l:e} m, w: {w:e} 1/s}}
coordinates: {{x: m, y: m}}
bodies: {{bob: {{mass: m, position: \"[x, y]\"}}}}
springs: {{spring: {{stretch: \"norm([x, y])\", stiffness: k, on: bob, along: \"[x, y]\"}}}}
scene: {{start: {{x: {l:e}, y: {h:e}, x': {speed:e}, y': {speed:e}}}, until: {t:e}}}
{claims}
",
        w = 1.0 / t,
        h = 0.5 * l,
    )
}

/// The same in polar coordinates, with a central force of a spring without length.
fn polar(s: &Sizes, claims: &str) -> String {
    let Sizes { m, l, k, t } = s;
    format!(
        "name: Polar
parameters: {{m: {m:e} kg, k: {k:e} N/m, d: {l:e} m, w: {w:e} 1/s}}
coordinates: {{r: m, phi: rad}}
bodies: {{bob: {{mass: m, position: \"r*[cos(phi), sin(phi)]\"}}}}
springs: {{spring: {{stretch: r, stiffness: k, on: bob, along: \"[cos(phi), sin(phi)]\"}}}}
scene: {{start: {{r: {l:e}, phi': {w:e}}}, until: {t:e}}}
sample: {{r: [{low:e} m, {high:e} m]}}
{claims}
",
        w = 1.0 / t,
        low = 0.5 * l,
        high = 2.0 * l,
    )
}

/// Two bodies on a line that pull at each other: momenta, and König's theorem.
fn pair(s: &Sizes, n: &Sizes, claims: &str) -> String {
    let Sizes { m, l, k, t } = s;
    format!(
        "name: Pair
parameters: {{m: {m:e} kg, M: {big:e} kg, k: {k:e} N/m, l: {l:e} m}}
coordinates: {{a: m, b: m}}
bodies: {{first: {{mass: m, position: \"[a, 0]\"}}, second: {{mass: M, position: \"[b, 0]\"}}}}
springs: {{between: {{stretch: a - b - l, stiffness: k, on: first, from: second, along: \"[1, 0]\"}}}}
scene: {{start: {{a: {l:e}, a': {speed:e}}}, until: {t:e}}}
{claims}
",
        big = n.m,
        speed = l / t,
    )
}

const CARTESIAN: [&str; 17] = [
    "checks: {c: \"((x + d)^2 - x^2 - 2*x*d - d^2)*k = 0\"}",
    "checks: {c: \"(x + y)^3 = x^3 + 3*x^2*y + 3*x*y^2 + y^3\"}",
    "checks: {c: \"x^4 - y^4 = (x - y)*(x + y)*(x^2 + y^2)\"}",
    "checks: {c: \"kinetic_energy = m*(x' + y')^2/4 + m*(x' - y')^2/4\"}",
    "checks: {c: \"potential_energy = k*(x^2 + y^2)/2\"}",
    "checks: {c: \"2*max(x, y) = x + y + abs(x - y)\"}",
    "checks: {c: \"min(x, y) + max(x, y) = x + y\"}",
    "checks: {c: \"abs(x) = x*sign(x)\"}",
    "checks: {c: \"step(x - d) + step(d - x) - abs(sign(x - d)) = 2 - 2*abs(sign(x - d))\"}",
    "checks: {c: \"sqrt(x^2) = abs(x)\"}",
    "checks: {c: \"exp(x/d)*exp(-x/d) = 1\"}",
    "checks: {c: \"ln(exp(y/d)) = y/d\"}",
    "checks: {c: \"cosh(x/d)^2 - sinh(x/d)^2 = 1\"}",
    "checks: {c: \"integral(3*s^2, s in 0..x) = x^3\"}",
    "checks: {c: \"tanh(x/d) = (exp(2*x/d) - 1)/(exp(2*x/d) + 1)\"}",
    "conserved: {energy: energy, spin: \"m*(x*y' - y*x')\"}",
    "conserved: {one: \"m*x'^2/2 + k*x^2/2\", other: \"m*x'*y' + k*x*y\"}",
];

const POLAR: [&str; 13] = [
    "checks: {c: \"kinetic_energy = m*(r'^2 + (r*phi')^2)/2\"}",
    "checks: {c: \"sin(phi)^2 + cos(phi)^2 = 1\"}",
    "checks: {c: \"2*sin(phi/2)^2 = 1 - cos(phi)\"}",
    "checks: {c: \"sin(2*phi) = 2*sin(phi)*cos(phi)\"}",
    "checks: {c: \"cos(3*phi) = 4*cos(phi)^3 - 3*cos(phi)\"}",
    "checks: {c: \"tan(phi)*cos(phi) = sin(phi)\"}",
    "checks: {c: \"r*cos(phi - w*t) = r*cos(phi)*cos(w*t) + r*sin(phi)*sin(w*t)\"}",
    "checks: {c: \"ln(r*d/d^2) = ln(r/d)\"}",
    "checks: {c: \"r^1.5*sqrt(r) = r^2\"}",
    "checks: {c: \"integral(cos(s), s in 0..phi) = sin(phi)\"}",
    "conserved: {energy: energy, spin: \"m*r^2*phi'\"}",
    "conserved: {energy: \"m*r'^2/2 + (m*r^2*phi')^2/(2*m*r^2) + k*r^2/2\"}",
    "conserved: {areal: \"r^2*phi'/2\"}",
];

const PAIR: [&str; 10] = [
    "conserved: {momentum: \"m*a' + M*b'\"}",
    "conserved: {energy: energy}",
    "conserved: {centre: \"(m*a + M*b) - (m*a' + M*b')*t\"}",
    "conserved: {within: \"m*M/(m + M)*(a' - b')^2/2 + k*(a - b - l)^2/2\"}",
    "checks: {c: \"kinetic_energy = (m + M)*((m*a' + M*b')/(m + M))^2/2 + m*M/(m + M)*(a' - b')^2/2\"}",
    "checks: {c: \"(m + M)*(m*a^2 + M*b^2) = (m*a + M*b)^2 + m*M*(a - b)^2\"}",
    "checks: {c: \"potential_energy = k*(a - b)^2/2 - k*(a - b)*l + k*l^2/2\"}",
    "checks: {c: \"abs(a - b) = max(a, b) - min(a, b)\"}",
    "checks: {c: \"a - (a - b) = b\"}",
    "checks: {c: \"m*velocity(first) + M*velocity(second) = [m*a' + M*b', 0]\"}",
];

fn refusal(text: &str) -> Option<String> {
    let problems = load(text, &[]).and_then(judged).err()?;
    Some(format!("{} {} {}\n{text}", problems[0].code, problems[0].message, problems[0].help))
}

#[test]
fn two_hundred_true_claims_at_scales_from_a_trillionth_to_a_trillion_are_accepted() {
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    let mut refused = Vec::new();
    let mut claims = 0;
    for _ in 0..5 {
        let texts = CARTESIAN.iter().map(|claim| cartesian(&Sizes::new(&mut numbers), claim)).collect::<Vec<_>>();
        let polars = POLAR.iter().map(|claim| polar(&Sizes::new(&mut numbers), claim)).collect::<Vec<_>>();
        let pairs = PAIR.iter().map(|claim| {
            let (first, second) = (Sizes::new(&mut numbers), Sizes::new(&mut numbers));
            pair(&first, &second, claim)
        });
        for text in texts.into_iter().chain(polars).chain(pairs) {
            claims += 1;
            refused.extend(refusal(&text));
        }
    }
    assert!(claims >= 200, "{claims}");
    assert!(refused.is_empty(), "{} of {claims} refused:\n{}", refused.len(), refused.join("\n"));
}

/// The same claims off by 1e-15 of their right sides, and claims that are true on one side of something only.
#[test]
fn false_neighbours_are_refused() {
    let mut numbers = Numbers(0x0123_4567_89ab_cdef);
    let mut accepted = Vec::new();
    let mut claims = 0;
    let mut refuse = |text: String| {
        claims += 1;
        if refusal(&text).is_none() {
            accepted.push(text);
        }
    };
    for claim in CARTESIAN.iter().filter_map(|claim| off(claim)) {
        refuse(cartesian(&Sizes::new(&mut numbers), &claim));
    }
    for claim in POLAR.iter().filter_map(|claim| off(claim)) {
        refuse(polar(&Sizes::new(&mut numbers), &claim));
    }
    for claim in PAIR.iter().filter_map(|claim| off(claim)) {
        let (first, second) = (Sizes::new(&mut numbers), Sizes::new(&mut numbers));
        refuse(pair(&first, &second, &claim));
    }
    for claim in [
        "conserved: {energy: energy + 1e-15*k*x^2}",
        "conserved: {spin: \"m*(x*y' - (1 + 1e-15)*y*x')\"}",
        "checks: {c: \"abs(x) = x\"}",
        "checks: {c: \"max(x, y) = x\"}",
        "checks: {c: \"min(x, 2*d) = x\"}",
        "checks: {c: \"sqrt((x - y)^2) = x - y\"}",
        "checks: {c: \"step(x + 3*d) = 1\"}",
        "checks: {c: \"x + 1e-15*d*step(x - 3*d) = x\"}",
        "checks: {c: \"sqrt(x^2 + (1e-6*d)^2) = abs(x)\"}",
        "conserved: {energy: energy + k*d^2*step(x - 2*d)}",
    ] {
        refuse(cartesian(&Sizes::new(&mut numbers), claim));
    }
    for claim in [
        "conserved: {spin: \"m*r^2*phi' + 1e-15*m*r^2*w*cos(phi)\"}",
        "checks: {c: \"asin(sin(phi)) = phi\"}",
        "checks: {c: \"acos(cos(phi)) = abs(phi)\"}",
        "checks: {c: \"atan(tan(phi)) = phi\"}",
        "checks: {c: \"2*abs(sin(phi/2)) = sqrt(2)*sqrt(1 - cos(phi)) + 1e-15\"}",
        "checks: {c: \"min(phi, 3.5) = phi\"}",
    ] {
        refuse(polar(&Sizes::new(&mut numbers), claim));
    }
    assert!(claims >= 40, "{claims}");
    assert!(accepted.is_empty(), "{} of {claims} accepted:\n{}", accepted.len(), accepted.join("\n"));
}

/// A check with its right side times 1 + 1e-15; `None` for other claims, and where that is 0.
fn off(claim: &str) -> Option<String> {
    let (left, right) = claim.strip_suffix("\"}").filter(|c| c.starts_with("checks"))?.split_once(" = ")?;
    // A vector's second component is 0 with any factor; its first is not.
    (right != "0").then(|| format!("{left} = (1 + 1e-15)*({right})\"}}"))
}
