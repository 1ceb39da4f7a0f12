//! The description in the words of FMI 3.0.

use std::fmt::Write;
use std::ops::Range;

use super::{Description, Variable, attribute, escaped};

/// The text of the file.
pub(super) fn text(all: &Description<'_>) -> String {
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"3.0\" {} instantiationToken=\"{}\">\n",
        all.head(),
        all.start.token
    );
    for (kind, more) in [
        ("ModelExchange", "needsCompletedIntegratorStep=\"true\""),
        ("CoSimulation", "canHandleVariableCommunicationStepSize=\"true\""),
    ] {
        let _ = writeln!(
            out,
            "  <{kind} modelIdentifier=\"{}\" canGetAndSetFMUState=\"true\" providesDirectionalDerivatives=\"{}\" {more}/>",
            all.prefix, all.has_slopes
        );
    }
    out += &all.common();
    out += "  <ModelVariables>\n";
    out.extend(all.variables.iter().map(number));
    if let Some(phase) = &all.phase {
        let _ = writeln!(
            out,
            "    <Int32 name=\"{}\" valueReference=\"{}\" causality=\"local\" variability=\"discrete\" initial=\"exact\" start=\"{}\" description=\"{}\"/>",
            escaped(&phase.name),
            phase.reference,
            all.start.phase,
            escaped(&phase.about)
        );
    }
    out += "  </ModelVariables>\n  <ModelStructure>\n";
    for (kind, range) in [
        ("Output", &all.states),
        ("Output", &all.outputs),
        ("ContinuousStateDerivative", &all.derivatives),
        ("InitialUnknown", &all.outputs),
        ("InitialUnknown", &all.derivatives),
        ("EventIndicator", &all.indicators),
    ] {
        out += &elements(kind, range);
    }
    out + "  </ModelStructure>\n</fmiModelDescription>\n"
}

fn number(variable: &Variable) -> String {
    let derivative = variable.derivative_of.map_or_else(String::new, |state| state.to_string());
    format!(
        "    <Float64 name=\"{}\" valueReference=\"{}\" {}{}{}{}{}/>\n",
        escaped(&variable.name),
        variable.reference,
        variable.attributes,
        attribute("derivative", &derivative),
        attribute("unit", &variable.unit),
        attribute("start", &variable.starts_at()),
        attribute("description", &variable.about)
    )
}

fn elements(kind: &str, range: &Range<usize>) -> String {
    range.clone().map(|k| format!("    <{kind} valueReference=\"{k}\"/>\n")).collect()
}
