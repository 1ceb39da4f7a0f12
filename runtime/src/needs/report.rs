//! The table, and the smaller file.

use std::fmt::{self, Write};

use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::file::edit::{replaced, value, with, with_at};

use super::prediction::WHOLE;
use super::told::part;
use super::{Choice, Deviation, Law, ModelReduction, Needs, Prediction, Proposal, Verdict};

impl Needs {
    /// Every ingredient with what leaving it out changes and saves, and what follows.
    pub fn table(&self) -> String {
        let mut text = format!("{}: {}, until t = {} s\n", self.name, self.wanted(), self.until);
        let _ = writeln!(
            text,
            "two runs of the full model agree to {}; {}",
            match self.need.absolute.is_empty() {
                true => self.part(self.known),
                false => format!("{} of what is asked for", self.part(self.known)),
            },
            match self.growth.is_nan() {
                true => "how a small change of the start grows is not known".to_owned(),
                false => format!("a small change of the start grows {} times", times(self.growth)),
            }
        );
        if let Some(t) = self.promised_until {
            let _ = writeln!(
                text,
                "no part of it is left out: it is chaotic, and can be promised until t = {t:.3} s at most"
            );
        }
        if !self.reductions.is_empty() {
            text.push('\n');
            if !self.need.absolute.is_empty() {
                text += "changes in parts of what is asked for\n";
            }
            text += &self.rows();
        }
        text.push('\n');
        text += &self.sentence();
        text
    }

    fn rows(&self) -> String {
        let head = [
            "ingredient",
            "proposed",
            "predicted",
            "change",
            "of",
            "phase error",
            "waveform error",
            "less work",
            "found",
        ]
        .map(str::to_owned);
        let rows: Vec<[String; COLUMNS]> =
            std::iter::once(head).chain(self.reductions.iter().map(|reduction| self.row(reduction))).collect();
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..COLUMNS).map(width).collect();
        let mut text = String::new();
        for row in rows {
            let cells: Vec<String> = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:width$}")).collect();
            text += cells.join("  ").trim_end();
            text.push('\n');
        }
        text
    }

    /// What the scene does without, in words.
    pub fn sentence(&self) -> String {
        if self.broken_off {
            return "what goes together was not found\n".to_owned();
        }
        let Some(choice) = &self.choice else {
            return format!("the full model is the cheapest that serves ({} operations)\n", count(self.operations));
        };
        let mut text = String::new();
        if choice.members.is_empty() {
            let _ = write!(text, "the model stays as it is, at a tolerance of {:e}", choice.tolerance);
        } else {
            text += &done(choice);
            if !choice.idle.is_empty() {
                let _ = write!(text, " (with it go {})", choice.idle.join(", "));
            }
            let _ = write!(text, ", at a tolerance of {:e}", choice.tolerance);
        }
        let _ = writeln!(
            text,
            ": {}; {} times less work ({} operations instead of {})",
            self.changes(choice),
            times(choice.saving),
            count(choice.operations),
            count(self.operations)
        );
        let serves = 1.5 * self.need.within;
        let asked = if self.need.absolute.is_empty() { "" } else { " of what is asked for" };
        let _ = match choice.moved {
            Some(moved) if moved <= serves => {
                writeln!(
                    text,
                    "from other starts, a hundredth of the way to where it goes, it is off by {}{asked} at most",
                    self.part(moved)
                )
            }
            Some(moved) => writeln!(
                text,
                "it holds for this start only: from others, a hundredth of the way to where it goes, it is off by {}{asked}",
                self.part(moved)
            ),
            None => writeln!(text, "it was not compared from other starts"),
        };
        if !choice.not_promised.is_empty() {
            let of = |(name, size): &(String, f64)| format!("{name} ({} of its range)", part(*size));
            let _ =
                writeln!(text, "not promised: {}", choice.not_promised.iter().map(of).collect::<Vec<_>>().join(", "));
        }
        for (claim, why) in &choice.gone {
            let _ = writeln!(text, "{claim} goes with it: {why}");
        }
        text
    }

    /// The smaller model as a file: the author's text without what goes, and what was found in comments above it.  `None` where
    /// there is none.
    pub fn smaller_file(&self) -> Option<String> {
        let choice = self.choice.as_ref()?;
        let mut head = format!("# Smaller than {}: for {} until t = {} s.\n", self.name, self.wanted(), self.until);
        for reduction in self.reductions.iter().filter(|reduction| choice.includes(reduction)) {
            let own = match &reduction.deviation {
                _ if reduction.not_depended_on => "; nothing wanted depends on it".to_owned(),
                deviation => deviation
                    .as_ref()
                    .map_or_else(String::new, |d| format!("; alone off by {}", self.off(d.largest, &d.of))),
            };
            let _ = writeln!(head, "# - {} {}{own}", reduction.ingredient, reduction.proposal);
        }
        for name in &choice.idle {
            let _ = writeln!(head, "# - {name} left out: it does nothing where that is held");
        }
        let _ = writeln!(
            head,
            "# Together {}, at the tolerance {:e}; {} times less work.",
            self.changes(choice),
            choice.tolerance,
            times(choice.saving)
        );
        if choice.moved.is_none_or(|moved| moved > 1.5 * self.need.within) {
            head += "# Known for this start only.\n";
        }
        for (name, size) in &choice.not_promised {
            let _ = writeln!(head, "# Not promised: {name} ({} of its range).", part(*size));
        }
        for (claim, why) in &choice.gone {
            let _ = writeln!(head, "# {claim} is not claimed any more: {why}");
        }
        let scene = self.scene.as_ref().map_or(vec!["scene"], |name| vec!["scenes", name]);
        let tolerance: Vec<Step> =
            scene.into_iter().chain(["tolerance"]).map(|key| Step::Key(key.to_owned())).collect();
        let looser = format!("{:e}", choice.tolerance);
        let text = match (value(&choice.text, &tolerance), &self.scene) {
            (Some(_), _) => replaced(&choice.text, &tolerance, &looser),
            (None, None) => with(&choice.text, "scene", "name", "tolerance", &looser),
            (None, Some(name)) => {
                with_at(&choice.text, &["scenes", name].map(|key| Step::Key(key.to_owned())), "tolerance", &looser)
            }
        };
        let text = text.unwrap_or_else(|| choice.text.clone());
        Some(head + &text)
    }

    fn row(&self, reduction: &ModelReduction) -> [String; COLUMNS] {
        let dash = || "–".to_owned();
        let (change, of) = match &reduction.deviation {
            Some(deviation) => (self.part(deviation.largest), deviation.of.clone()),
            None => (dash(), dash()),
        };
        let saving = if reduction.saving > 0.0 { times(reduction.saving) } else { dash() };
        let found = match &reduction.deviation {
            // One that runs ahead by a constant part is late, not otherwise.
            Some(d)
                if reduction.verdict == Verdict::Acts && d.parts().is_some() && d.waveform_error < 0.2 * d.largest =>
            {
                format!("needed: the same, {} {}", part(d.phase_error.abs()), faster_or_slower(d.phase_error))
            }
            _ if reduction.not_depended_on && reduction.verdict == Verdict::Serves => {
                "nothing wanted depends on it".to_owned()
            }
            _ => reduction.verdict.to_string(),
        };
        let found = match &reduction.margin {
            Some((guard, margin)) if reduction.verdict == Verdict::Serves => {
                format!("{found}; {guard} is missed by {} of its range", times(*margin))
            }
            _ => found,
        };
        let found = match reduction.predicted.filter(|predicted| !predicted.holds()) {
            Some(Prediction { law: Law::Stiff { .. }, change }) if change > WHOLE => {
                format!("{found}; no law: it would be no small change")
            }
            Some(predicted @ Prediction { law: Law::Stiff { .. } | Law::Linear { .. }, .. }) => {
                format!("{found}; no law: {}", self.need.told_prediction(predicted).law)
            }
            _ => found,
        };
        // Where its law does not hold nothing is predicted.
        let predicted =
            reduction.predicted.filter(Prediction::holds).map_or_else(dash, |predicted| self.part(predicted.change));
        let parts = reduction.deviation.as_ref().and_then(Deviation::parts);
        let [phase_error, waveform_error] =
            parts.map_or_else(|| [dash(), dash()], |(phase_error, waveform)| [part(phase_error), self.part(waveform)]);
        [
            reduction.ingredient.clone(),
            reduction.proposal.to_string(),
            predicted,
            change,
            of,
            phase_error,
            waveform_error,
            saving,
            found,
        ]
    }

    /// `predicted 4.1e-4, found 4.2e-4; off by 4.3e-4 of swing, integration included`.
    fn changes(&self, choice: &Choice) -> String {
        let of_model = |predicted| format!("predicted {}, found {}; ", self.part(predicted), self.part(choice.change));
        let of_parts = |(phase_error, waveform_error)| {
            format!(" (phase error {}, waveform error {})", part(phase_error), self.part(waveform_error))
        };
        format!(
            "{}off by {}{}, integration included",
            choice.predicted.map_or_else(String::new, of_model),
            self.off(choice.verified, &choice.of),
            choice.parts.map_or_else(String::new, of_parts)
        )
    }

    /// A deviation, as it is told.
    fn part(&self, deviation: f64) -> String {
        part(self.need.told(deviation))
    }
}

/// Of the table.
const COLUMNS: usize = 9;

/// `it does without forces.drag and with coordinates.l held at 10 m`.
fn done(choice: &Choice) -> String {
    let members = || choice.members.iter().zip(&choice.proposals);
    let gone = members().filter(|(_, proposal)| **proposal == Proposal::LeftOut).map(|(name, _)| name.clone());
    let others = members().filter(|(_, proposal)| **proposal != Proposal::LeftOut);
    let others = others.map(|(name, proposal)| format!("{name} {proposal}"));
    let [gone, others] = [gone.collect::<Vec<_>>().join(", "), others.collect::<Vec<_>>().join(", ")];
    match (gone.is_empty(), others.is_empty()) {
        (false, true) => format!("it does without {gone}"),
        (true, false) => format!("it does with {others}"),
        _ => format!("it does without {gone} and with {others}"),
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Serves => f.write_str("not needed"),
            Verdict::Acts => f.write_str("needed"),
            Verdict::HappensOtherwise { what } => write!(f, "needed: {what}"),
            Verdict::Near { guard, margin } => write!(f, "stays: {guard} is missed by {} of its range", part(*margin)),
            Verdict::Refused { why } => write!(f, "stays: without it, {why}"),
        }
    }
}

/// What changes less is rounding.
const LEAST: f64 = 1e-12;

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Law::Proportional { second } => write!(f, "the second approximation adds {} of the first", part(*second)),
            Law::Richer { kept } => write!(f, "beside {kept} modes"),
            Law::Stiff { gap, vibration } if *vibration > LEAST => {
                write!(f, "{} times faster than the rest, its vibration changes {}", times(*gap), part(*vibration))
            }
            Law::Linear { power, second } => write!(
                f,
                "it grows with the amplitude to the power {power:.1}, and the second approximation adds {} of the first",
                part(*second)
            ),
            Law::Stiff { gap, .. } => write!(f, "{} times faster than the rest", times(*gap)),
        }
    }
}

fn faster_or_slower(phase_error: f64) -> &'static str {
    if phase_error > 0.0 { "faster" } else { "slower" }
}

impl fmt::Display for Proposal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Proposal::LeftOut => f.write_str("left out"),
            Proposal::Held { at } => write!(f, "held at {at}"),
            Proposal::Slaved { to } => write!(f, "following {to}"),
            Proposal::Linear => f.write_str("linear"),
            Proposal::Rigid { at } => write!(f, "rigid at {at}"),
            Proposal::Looser { tolerance, own } => write!(f, "{tolerance:e} instead of {own:e}"),
            Proposal::Modes { kept, of } => write!(f, "in {kept} of its {of} modes"),
        }
    }
}

fn times(value: f64) -> String {
    match value {
        v if v < 10.0 => format!("{v:.2}"),
        v if v < 1e4 => format!("{v:.0}"),
        v => format!("{v:.0e}"),
    }
}

fn count(value: f64) -> String {
    format!("{value:.0}")
}
