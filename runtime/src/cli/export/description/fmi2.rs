//! The description in the words of FMI 2.0, which refers to variables by their places, from 1.

use std::fmt::Write;

use super::{Description, Variable, attribute, escaped};

/// The text of the file, with the files to compile.
pub(super) fn text(all: &Description<'_>, sources: &[String]) -> String {
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\" {} guid=\"{}\" numberOfEventIndicators=\"{}\">\n",
        all.head(),
        all.start.token,
        all.indicators.len()
    );
    let files: String = sources.iter().map(|file| format!("      <File name=\"{file}\"/>\n")).collect();
    for (kind, more) in [("ModelExchange", ""), ("CoSimulation", " canHandleVariableCommunicationStepSize=\"true\"")] {
        let _ = writeln!(
            out,
            "  <{kind} modelIdentifier=\"{}\" canGetAndSetFMUstate=\"true\" providesDirectionalDerivative=\"{}\"{more}>\n    <SourceFiles>\n{files}    </SourceFiles>\n  </{kind}>",
            all.prefix, all.has_slopes
        );
    }
    out += &all.common();
    out += "  <ModelVariables>\n";
    out.extend(all.variables.iter().map(|variable| number(all, variable)));
    if let Some(phase) = &all.phase {
        let _ = writeln!(
            out,
            "    <ScalarVariable name=\"{}\" valueReference=\"{}\" causality=\"local\" variability=\"discrete\" initial=\"exact\" description=\"{}\">\n      <Integer start=\"{}\"/>\n    </ScalarVariable>",
            escaped(&phase.name),
            phase.reference,
            escaped(&phase.about),
            all.start.phase
        );
    }
    out += "  </ModelVariables>\n  <ModelStructure>\n";
    out += &list(all, "Outputs", all.states.clone().chain(all.outputs.clone()));
    out += &list(all, "Derivatives", all.derivatives.clone());
    out += &list(all, "InitialUnknowns", all.derivatives.clone().chain(all.outputs.clone()));
    out + "  </ModelStructure>\n</fmiModelDescription>\n"
}

/// The place of a variable among all, from 1.
fn place(all: &Description<'_>, reference: usize) -> usize {
    1 + all.variables.partition_point(|variable| variable.reference < reference)
}

fn number(all: &Description<'_>, variable: &Variable) -> String {
    let derivative = variable.derivative_of.map_or_else(String::new, |state| place(all, state).to_string());
    format!(
        "    <ScalarVariable name=\"{}\" valueReference=\"{}\" {}{}>\n      <Real{}{}{}/>\n    </ScalarVariable>\n",
        escaped(&variable.name),
        variable.reference,
        variable.attributes,
        attribute("description", &variable.about),
        attribute("unit", &variable.unit),
        attribute("start", &variable.starts_at()),
        attribute("derivative", &derivative)
    )
}

/// A list of unknowns in the order of their places.
fn list(all: &Description<'_>, kind: &str, references: impl Iterator<Item = usize>) -> String {
    let unknown = |reference| format!("      <Unknown index=\"{}\"/>\n", place(all, reference));
    let unknowns: String = references.map(unknown).collect();
    format!("    <{kind}>\n{unknowns}    </{kind}>\n")
}
