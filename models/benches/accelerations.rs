//! Nanoseconds per evaluation of the accelerations of the n-link chain: generated code against code written by hand.
//!
//! `cargo bench -p dalembert-models`.  Both are timed in turns in one run, each call depends on the last, and the
//! medians of 31 rounds are compared, since the machine may be shared.

use std::hint::black_box;
use std::time::Instant;

use dalembert::mechanism::Mechanism;

dalembert::model!("chain.yaml", n = 1, name = Chain1);
dalembert::model!("chain.yaml", n = 2, name = Chain2);
dalembert::model!("chain.yaml", n = 3, name = Chain3);
dalembert::model!("chain.yaml", n = 5, name = Chain5);
dalembert::model!("chain.yaml", n = 10, name = Chain10);

fn main() {
    println!("| n | by hand, ns | generated, ns | ratio |\n| ---: | ---: | ---: | ---: |");
    compare::<Chain1, 1>();
    compare::<Chain2, 2>();
    compare::<Chain3, 3>();
    compare::<Chain5, 5>();
    compare::<Chain10, 10>();
}

fn compare<M: Mechanism<N, 0> + Default, const N: usize>() {
    let constants = M::constants::<f64>(|_| M::default());
    let rods = Rods { m: 1.0, l: 1.0, g: 10.0 };
    let generated = |q: &[f64; N], v: &[f64; N], a: &mut [f64; N]| {
        M::accelerations::<f64>(&constants, 0.0, &[], q, v, a).expect("a chain's mass matrix is regular");
    };
    let by_hand = |q: &[f64; N], v: &[f64; N], a: &mut [f64; N]| rods.accelerations(q, v, a);
    agree(&generated, &by_hand);
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..31 {
        theirs.push(nanoseconds(&by_hand));
        ours.push(nanoseconds(&generated));
    }
    let (ours, theirs) = (median(ours), median(theirs));
    println!("| {N} | {theirs:.1} | {ours:.1} | {:.2} |", ours / theirs);
}

fn agree<const N: usize>(
    f: &impl Fn(&[f64; N], &[f64; N], &mut [f64; N]),
    g: &impl Fn(&[f64; N], &[f64; N], &mut [f64; N]),
) {
    let q = std::array::from_fn(|i| 0.3 + 0.7 * i as f64);
    let v = std::array::from_fn(|i| 1.1 - 0.4 * i as f64);
    let (mut a, mut b) = ([0.0; N], [0.0; N]);
    f(&q, &v, &mut a);
    g(&q, &v, &mut b);
    for (x, y) in a.iter().zip(&b) {
        assert!((x - y).abs() <= 1e-10 * (1.0 + y.abs()), "{a:?} {b:?}");
    }
}

/// Per call, over some tenths of a millisecond; the state moves with the result.
fn nanoseconds<const N: usize>(f: &impl Fn(&[f64; N], &[f64; N], &mut [f64; N])) -> f64 {
    let calls = 20_000 / (N * N);
    let (mut q, v, mut a) = ([0.4; N], [0.2; N], [0.0; N]);
    let start = Instant::now();
    for _ in 0..calls {
        f(&q, &v, &mut a);
        q[N - 1] += 1e-9 * a[0];
    }
    let elapsed = start.elapsed().as_secs_f64();
    black_box(a);
    1e9 * elapsed / calls as f64
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// What a person writes for n uniform rods in absolute angles: one sine and cosine a rod, M in product form, LDLᵀ.
struct Rods {
    m: f64,
    l: f64,
    g: f64,
}

impl Rods {
    fn accelerations<const N: usize>(&self, q: &[f64; N], v: &[f64; N], a: &mut [f64; N]) {
        let (mut s, mut c) = ([0.0; N], [0.0; N]);
        for i in 0..N {
            (s[i], c[i]) = q[i].sin_cos();
        }
        let mut mass = [[0.0; N]; N];
        let ml2 = self.m * self.l * self.l;
        for i in 0..N {
            let beyond = (N - 1 - i) as f64;
            mass[i][i] = ml2 * (1.0 / 3.0 + beyond);
            a[i] = -self.m * self.g * self.l * (0.5 + beyond) * s[i];
        }
        for i in 0..N {
            let k = ml2 * (0.5 + (N - 1 - i) as f64);
            for j in 0..i {
                mass[i][j] = k * (c[i] * c[j] + s[i] * s[j]);
                let turning = k * (s[i] * c[j] - c[i] * s[j]);
                a[i] -= turning * v[j] * v[j];
                a[j] += turning * v[i] * v[i];
            }
        }
        // LDLᵀ, then forward and back substitution.
        for i in 0..N {
            for j in 0..i {
                for k in 0..j {
                    mass[i][j] -= mass[i][k] * mass[j][k];
                }
            }
            for j in 0..i {
                let factor = mass[i][j] * mass[j][j];
                mass[i][i] -= factor * mass[i][j];
                mass[i][j] = factor;
                a[i] -= factor * a[j];
            }
            mass[i][i] = 1.0 / mass[i][i];
        }
        for i in (0..N).rev() {
            a[i] *= mass[i][i];
            for j in i + 1..N {
                a[i] -= mass[j][i] * a[j];
            }
        }
    }
}
