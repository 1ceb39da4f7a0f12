//! scratch
use dalembert_symbolic::{derive, expr::*, lower, model::*};
fn chain(n: usize, relative: bool) -> Model {
    let mut m = Model { dimension: 2, ..Default::default() };
    let g = &mut m.graph;
    let names = ["m", "l", "g", "I"];
    let p: Vec<Id> = (0..4).map(|i| g.symbol(Symbol::Parameter(i))).collect();
    let mut tip = vec![Id::ZERO, Id::ZERO];
    let mut angle = Id::ZERO;
    let half = g.rational(Rational::new(1, 2).unwrap());
    for i in 0..n {
        let q = g.symbol(Symbol::Coordinate(i as u32));
        angle = if relative { g.add(angle, q) } else { q };
        let s = g.unary(Unary::Sin, angle);
        let c = g.unary(Unary::Cos, angle);
        let c = g.neg(c);
        let mut next = tip.clone();
        let mut com = tip.clone();
        for (k, d) in [s, c].into_iter().enumerate() {
            let ld = g.mul(p[1], d);
            next[k] = g.add(tip[k], ld);
            let h = g.mul(half, ld);
            com[k] = g.add(tip[k], h);
        }
        m.bodies.push(Body {
            name: format!("b{i}"),
            mass: p[0],
            position: com,
            rotation: Some(Rotation { angle, inertia: p[3] }),
            place: Default::default(),
        });
        m.coordinates.push(Coordinate { name: format!("theta{}", i + 1), unit: None, place: Default::default() });
        tip = next;
    }
    let gy = g.neg(p[2]);
    m.gravity = Some(vec![Id::ZERO, gy]);
    let until = g.integer(10);
    for (i, n) in names.iter().enumerate() {
        m.parameters.push(Parameter {
            name: n.to_string(),
            family: None,
            unit: None,
            default: [1.0, 1.0, 10.0, 1.0 / 12.0][i],
            place: Default::default(),
        });
    }
    m.scenes.push(Scene {
        name: "scene".into(),
        q: vec![Id::ZERO; n],
        v: vec![Id::ZERO; n],
        until,
        tolerance: until,
        every: None,
        set: vec![],
    });
    m
}
fn main() {
    for relative in [false, true] {
        for n in [1, 2, 3, 5, 10, 20, 40] {
            let m = chain(n, relative);
            let t = std::time::Instant::now();
            let d = derive::derive(m).unwrap();
            let t1 = t.elapsed();
            let worst = d.report.agreements[0].worst;
            let p = lower::lower(d).unwrap();
            println!(
                "{relative} n={n} {:?} derive {:?} total {:?} {} {worst:e} graph {}",
                p.counts,
                t1,
                t.elapsed(),
                p.choice,
                p.model.graph.len()
            );
        }
    }
}
