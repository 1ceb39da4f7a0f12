// `docs/faults.md`.

use std::collections::BTreeMap;
use std::fmt::Write;

use dalembert_symbolic::diagnose::catalogue::CATALOGUE;
use dalembert_symbolic::file::render;
use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;

use super::held::Held;
use super::parts::Slipped;
use super::shared::{Notice, notices};
use super::smallest::Smallest;
use super::{Fate, Outcome, models, sound};

const HEAD: &str = "# Seeded faults

Each fault below is planted alone, in one derivation of a model that has `balances`, `checks` or `conserved`, which is
then judged with nothing but the spoilt part to notice it: the one system of balances, or the one claim. Balances written
out by hand are those of `symbolic/tests/faults/written`; models of several scales (a rotor of 1e-9 kg m² on a slide of
10 kg, an orbit in metres, a molecule, a grain of dust beside a planet) are those of `symbolic/tests/faults/scales`.
*Caught by comparison* is a verdict: the two sides differ. *Refused by name* is any other error (counts that do not fit, a
system that has become singular, a placement that makes no sense). *Motion unchanged* are faults that are none: the
accelerations are the same (a moment about another point of a complete system, a mass that cancels); they are listed below
and not counted. A wrong reaction of an equation that is written out is a fault although the motion is the same; where nothing
else tells what it is (a guide that is not named may take anything), `check` says on which equation it rests, and these
stand under *named by `check`*. The rate is what was refused of the rest. Faults that act in phases only for which the file has no system
of balances are not planted: nothing could notice them, and `check` says which phases were not compared. Where a model offers more than 8 faults of one kind, at most 8
are planted, evenly chosen; long chains are shortened.

## Who decides what is a fault

Not the gate. It puts accelerations into equations, and measures what is left of an equation by running magnitudes: sums of
everything that rounding could act on. The study has states of its own (from each scene's motion by Runge and Kutta's
method, about the start and at large, a thousandth and ten times as far too, on both sides of discontinuities, and within
the place or the while in which a fault acts; in every phase, and brought to the constraints of it to 29 digits by Newton's
method), a solver of its own in double-double, and another measure. It *solves* the spoilt equations, together with the
constraints, which it differentiates itself, and compares each acceleration with the sound one by its own row: |aᵢ| +
Σⱼ|Mᵢⱼ aⱼ|/Mᵢᵢ + (the largest single term of hᵢ, products multiplied out)/Mᵢᵢ + Σₖ|Jₖᵢ λₖ|/Mᵢᵢ. A check is measured by the largest single term of its sides, a conserved
quantity by the largest single term of its rate. A fault is one from 1e-9 of a row on: none of these may be missed. What moves
no row by more than 1e-24 is none: where the gate refuses it, that is a false alarm, and there may be none of these either.

Beneath this, every entry of M, h and the residual of either of the program's own two derivations is multiplied by 1 + 1e-12,
flipped and dropped in the unit tests of `gate::agreement`; each such fault is E503.

Regenerate: `cargo run --release --example faults -p dalembert-symbolic > docs/faults.md`.

## Faults by kind

";

const SMALLEST: &str = "
## The smallest fault that is caught

One term is multiplied by 1 + 10⁻ᵏ, and k is sought at which it is just refused, for terms of some models of the library
and of several scales. A term that is small beside the others of its equation must be off by more of itself than one
that is all of it: the gate says that an equation holds to twenty digits of its magnitude.

";

const HELD: &str = "
## Constraints

Rows of constraints are differentiated forward, which gives c', J, γ, the rate of what moves them and the forces Jᵀλ, and
once more by reverse passes; the gate holds one against the other, entry by entry, at its states. Here entries of the first
are multiplied by 1 + 1e-12, flipped and dropped, in every model of the library that has constraints. The jumps of the
speeds at impacts and where phases are entered are held against balances of force and moment, integrated over the instant.
The unit tests of `gate::impulses` spoil components of Δq' likewise: of a dumbbell of which one ball meets a floor and of
two hinged bars that a peg catches all that change, 21 faults, each of which is E516. Of a ball that bounces only one speed
changes, by the one reaction that changes it: the reaction takes any impulse, and no balance can tell a wrong one.

What both derivations share they cannot see: a constraint as the file states it, the phases in which it acts, a coefficient
of restitution, when an event happens. A wrong length there is another mechanism, derived without a fault; `checks`,
`conserved` and reactions that balances name are what may notice it.

";

const PARTS_OF_THE_GATE: &str = "
## What each part of the gate is for

Every fault above that is caught by comparison, judged once more with one part of the gate turned off: *precision* (nine
digits in place of twenty), *rows* (by the largest of all rows, no coordinate moving alone), *motion* (no states from
the scenes' motion), *sides* (no states on both sides of discontinuities). Those that are then accepted slip through.

";

const SHARED: &str = "
## What no second derivation can see

Masses, inertias, gravity and stiffnesses are given once and used by every derivation. Where one is wrong, all of them
agree on the wrong motion. Two things help: a system of balances that writes a datum out again (`equation: \"…\"`), and
a claim in `checks` or `conserved` that was derived elsewhere, by hand or in a book. Here the whole of each model is
compiled with one such fault; *noticed by nobody* is what to expect of a model without `checks`.

";

const EXAMPLE: &str = "
A real example: in `models/double_pendulum.yaml` the lower bar is given twice its mass, `fore: {mass: 2*m, …}`. The two
systems of balances agree with Lagrange's equations, energy is conserved, and without its `checks` the model compiles.
Its one check, the kinetic energy as worked out by hand, does not hold:

";

const UNCHANGED: &str = "
## Faults that leave the motion unchanged

All of them, read one by one. They are of five sorts:

- *Another balance that is as true.* Moments about another point, of other bodies, forces in another direction: each is a
  theorem about the same motion, and as long as the system stays complete the accelerations are the same. These are the
  lines under `about`, `of` and, for a force balance, `along` (a direction is normalised, so its length and sign do not
  count either).
- *The same in other words.* `mass[3]` for `mass[n]`, a point by its name for its expression, `-(0)` for `0`, the factors
  of a cross product that is to vanish in the other order, both sides of an equation whose right side is 0 scaled at once,
  `position + hinge` where the hinge is the origin, a part that is zero.
- *Only the sign of a reaction.* Of `along` the opposite direction counts the force the other way, which is a choice; in
  a balance that the program forms, its size cannot be wrong. In equations written out by hand it can: there the force and
  moment of every reaction on every body are compared with those of the sound file.
- *What is not used.* Where springs and dampers act, in a model whose balances are all written out; a term of an energy
  that the derivative in front of it drops (the weight in `diff(…, theta')`).
- *Symmetry.* The opposite of a coordinate in which the energies are even; a mass that cancels, or of a body that stays
  where it is; a part of a balance that holds with any factor (the areal velocity of a central force, the pull in the
  moment about its centre).
";

/// The rates by kind of fault.
fn rates(outcomes: &[Outcome]) -> String {
    let mut kinds: BTreeMap<&str, [usize; 6]> = BTreeMap::new();
    let mut all = [0; 6];
    for outcome in outcomes {
        let column = match outcome.fate {
            Fate::Caught => 1,
            Fate::Named(_) => 2,
            Fate::Unchanged | Fate::Alarm | Fate::Slight => 3,
            Fate::Missed => 4,
            Fate::Told => 5,
        };
        for counts in [&mut all, kinds.entry(&outcome.kind).or_default()] {
            counts[0] += 1;
            counts[column] += 1;
        }
    }
    let mut text = String::from(
        "| fault | planted | caught by comparison | refused by name | motion unchanged | named by `check` | missed | rate |\n\
         | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
    );
    for (kind, c) in kinds.into_iter().chain([("**all**", all)]) {
        let counted = c[0] - c[3] - c[5];
        let rate = if counted == 0 {
            "–".to_owned()
        } else {
            format!("{:.1} %", 100.0 * (c[1] + c[2]) as f64 / counted as f64)
        };
        let _ = writeln!(text, "| {kind} | {} | {} | {} | {} | {} | {} | {rate} |", c[0], c[1], c[2], c[3], c[5], c[4]);
    }
    text
}

/// The whole page.
pub fn page(outcomes: &[Outcome], smallest: &Smallest, held: &Held) -> String {
    let example = example();
    let (rates, shared) = (rates(outcomes), shared());
    let (named, listed) = (named(outcomes), listed(outcomes));
    let (smallest, parts, held) = (sizes(smallest), parts(outcomes), rows(held));
    let noticed = format!("{SHARED}{shared}{EXAMPLE}```text\n{example}```\n");
    format!("{HEAD}{rates}\n{named}{SMALLEST}{smallest}{HELD}{held}{PARTS_OF_THE_GATE}{parts}{noticed}{listed}")
}

/// The smallest faults by kind.
fn sizes(smallest: &Smallest) -> String {
    let mut text = String::from(
        "| fault: a factor of 1 + 10⁻ᵏ | terms | caught of every term | caught of half the terms | caught of some term |\n\
         | --- | ---: | ---: | ---: | ---: |\n",
    );
    for (kind, digits) in smallest {
        let mut digits = digits.clone();
        digits.sort_unstable();
        let (Some(least), Some(most)) = (digits.first(), digits.last()) else { continue };
        let middle = digits[digits.len() / 2];
        let _ = writeln!(text, "| {kind} | {} | 1e-{least} | 1e-{middle} | 1e-{most} |", digits.len());
    }
    text
}

/// Faults in constraints by kind.
fn rows(held: &Held) -> String {
    let mut text = String::from("| fault in | planted | refused |\n| --- | ---: | ---: |\n");
    for (kind, (planted, refused)) in held {
        let _ = writeln!(text, "| {kind} | {planted} | {refused} |");
    }
    text
}

/// What slips through without each part of the gate.
fn parts(outcomes: &[Outcome]) -> String {
    let mut text = String::from("| turned off | slip through | for instance |\n| --- | ---: | --- |\n");
    for slipped in Slipped::of(outcomes) {
        // A different example each, from the models that were made for it where there are some.
        let example = slipped.faults.iter().find(|o| o.model.starts_with("scales")).or(slipped.faults.first());
        let words = example.map_or_else(String::new, |o| format!("{}: {}: {}", o.model, o.kind, o.what));
        let _ = writeln!(text, "| {} | {} | {words} |", slipped.part, slipped.faults.len());
    }
    text
}

/// The errors by which faults were refused without a comparison.
fn named(outcomes: &[Outcome]) -> String {
    let mut codes: BTreeMap<&str, usize> = BTreeMap::new();
    for outcome in outcomes {
        if let Fate::Named(code) = outcome.fate {
            *codes.entry(code).or_default() += 1;
        }
    }
    let title =
        |code: &str| CATALOGUE.iter().copied().flatten().find(|entry| entry.code == code).map_or("", |e| e.title);
    let words: Vec<String> = codes.iter().map(|(code, n)| format!("{n} by {code} ({})", title(code))).collect();
    format!("Refused by name: {}.\n", words.join(", "))
}

/// Who notices faults in shared data.
fn shared() -> String {
    let mut kinds: BTreeMap<&str, [usize; 6]> = BTreeMap::new();
    for sound in models().iter().filter_map(|name| sound(name)) {
        for (kind, notice) in notices(&sound) {
            let counts = kinds.entry(kind).or_default();
            counts[0] += 1;
            counts[match notice {
                Notice::Balances => 1,
                Notice::Claims => 2,
                Notice::Nobody => 3,
                Notice::Same => 4,
            }] += 1;
        }
    }
    let mut text = String::from(
        "| fault | planted | noticed by balances | noticed by `checks` or `conserved` | noticed by nobody | motion unchanged |\n\
         | --- | ---: | ---: | ---: | ---: | ---: |\n",
    );
    for (kind, c) in kinds {
        let _ = writeln!(text, "| {kind} | {} | {} | {} | {} | {} |", c[0], c[1], c[2], c[3], c[4]);
    }
    text
}

/// What is said of a double pendulum with a wrong mass.
fn example() -> String {
    let text = include_str!("../../../models/double_pendulum.yaml").replace("fore:  {mass: m,", "fore:  {mass: 2*m,");
    let problems = load(&text, &[]).and_then(judged).err().unwrap_or_default();
    render("double_pendulum.yaml", &text, &problems)
}

/// The faults that are none.
fn listed(outcomes: &[Outcome]) -> String {
    let mut groups: BTreeMap<&str, BTreeMap<&str, Vec<&str>>> = BTreeMap::new();
    for outcome in outcomes.iter().filter(|o| o.fate == Fate::Unchanged) {
        groups.entry(&outcome.kind).or_default().entry(&outcome.model).or_default().push(&outcome.what);
    }
    let mut text = UNCHANGED.to_owned();
    for (kind, models) in groups {
        let _ = write!(text, "\n{kind}:\n");
        for (model, what) in models {
            let _ = writeln!(text, "- {model}: {}", what.join("; "));
        }
    }
    text
}
