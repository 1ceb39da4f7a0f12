//! Slopes, and rounding errors, of what an interpreted mechanism puts out.

use dalembert_symbolic::expr::{Binary, DoubleDouble, Id, Scalar, Symbol, Tape, Unary};
use dalembert_symbolic::interpret::{self, Function, Interpreter};

use crate::mechanism::dual::{Dual, replaced_input};
use crate::mechanism::system::Replaced;
use crate::mechanism::{self, Along, Real};

/// Slopes of a function's numbers along a direction, [`System::slopes`](crate::mechanism::System::slopes).
pub(super) fn slopes(
    interpreter: &Interpreter,
    signals: &[Option<Replaced>],
    (at, along): (mechanism::At<'_>, &Along<'_>),
    function: mechanism::Function,
    values: &mut [f64],
) {
    let program = interpreter.program();
    let parameter = |k: u32| f64::from(u8::from(along.parameter == Some(k as usize)));
    let plain = |symbol: Symbol| match symbol {
        Symbol::Time => Dual::moving(at.t, along.t),
        Symbol::Parameter(k) => Dual::moving(interpreter.value(symbol, interpret::At::default()), parameter(k)),
        Symbol::Memory(j) => {
            let slope = f64::from(u8::from(along.memory == Some(j as usize)));
            Dual::moving(interpreter.value(symbol, interpret::At::default()), slope)
        }
        _ => Dual::constant(interpreter.value(symbol, interpret::At::default())),
    };
    let mut inputs = vec![Dual::constant(0.0); 3 * program.model.inputs.len()];
    interpreter.evaluate_in(Function::Inputs, plain, &mut inputs);
    for (signal, slot) in signals.iter().zip(inputs.chunks_exact_mut(3)) {
        if let Some(signal) = signal {
            slot.copy_from_slice(&replaced_input(signal.at(at.t), along.t));
        }
    }
    let of = |list: &[f64], k: u32| list.get(k as usize).copied().unwrap_or(0.0);
    let value = |symbol: Symbol| match symbol {
        Symbol::Coordinate(i) => Dual::moving(of(at.q, i), of(along.q, i)),
        Symbol::Speed(i) => Dual::moving(of(at.v, i), of(along.v, i)),
        Symbol::Acceleration(i) => Dual::moving(of(at.a, i), of(along.a, i)),
        Symbol::Multiplier(k) => Dual::moving(of(at.lambda, k), of(along.lambda, k)),
        Symbol::Input(k, order) => inputs[3 * k as usize + usize::from(order)],
        _ => plain(symbol),
    };
    let mut room = vec![Dual::constant(0.0); values.len()];
    let roots = |roots: &[Id], room: &mut [Dual]| {
        Tape::new(&program.model.graph, roots).run(value, &mut Vec::new(), room);
    };
    match function {
        mechanism::Function::Residual => interpreter.evaluate_in(Function::Residual, value, &mut room),
        mechanism::Function::RowAccelerations => {
            let entries = &program.constraints.matrix;
            let mut jacobian = vec![Dual::constant(0.0); entries.len()];
            interpreter.evaluate_in(Function::ConstraintBias, value, &mut room);
            interpreter.evaluate_in(Function::ConstraintMatrix, value, &mut jacobian);
            for ((row, column, _), slope) in entries.iter().zip(jacobian) {
                room[*row] = room[*row] + slope * value(Symbol::Acceleration(*column as u32));
            }
        }
        mechanism::Function::Constraints => interpreter.evaluate_in(Function::Constraints, value, &mut room),
        mechanism::Function::Events => interpreter.evaluate_in(Function::Events, value, &mut room),
        mechanism::Function::Assignments => interpreter.evaluate_in(Function::Assignments, value, &mut room),
        mechanism::Function::Switches => interpreter.evaluate_in(Function::Switches, value, &mut room),
        mechanism::Function::Outputs => interpreter.evaluate_in(Function::Outputs, value, &mut room),
        mechanism::Function::Energies => interpreter.evaluate_in(Function::Energy, value, &mut room),
        mechanism::Function::Invariants => interpreter.evaluate_in(Function::Invariants, value, &mut room),
        mechanism::Function::StartConditions => interpreter.evaluate_in(Function::StartConditions, value, &mut room),
        mechanism::Function::Restitutions => roots(&program.restitutions(), &mut room),
        mechanism::Function::Scene(scene) => {
            let Some(scene) = program.model.all_scenes().nth(scene) else { return values.fill(0.0) };
            let settings = [scene.until, scene.tolerance, scene.every.unwrap_or(Id::ZERO)];
            let numbers: Vec<Id> = settings.into_iter().chain(scene.q.iter().chain(&scene.v).copied()).collect();
            roots(&numbers, &mut room);
        }
    }
    values.iter_mut().zip(room).for_each(|(slope, value)| *slope = value.slope);
}

/// Fills the columns of [`System::output_slopes`](crate::mechanism::System::output_slopes).
pub(super) fn output_slopes(interpreter: &Interpreter, at: interpret::At<'_>, size: usize, columns: &mut [f64]) {
    let program = interpreter.program();
    let (n, rows) = (program.model.coordinates.len(), program.constraints.len());
    let clock = 3 * n + rows + 3 * program.model.inputs.len();
    let column_of = |symbol: Symbol| match symbol {
        Symbol::Coordinate(i) => Some(i as usize),
        Symbol::Speed(i) => Some(n + i as usize),
        Symbol::Acceleration(i) => Some(2 * n + i as usize),
        Symbol::Multiplier(k) => Some(3 * n + k as usize),
        Symbol::Input(k, order) => Some(3 * n + rows + 3 * k as usize + usize::from(order)),
        Symbol::Time => Some(clock),
        _ => None,
    };
    let mut values = vec![Dual::constant(0.0); size];
    for (k, column) in columns.chunks_exact_mut(size.max(1)).enumerate() {
        let value = |symbol: Symbol| {
            let slope = f64::from(u8::from(column_of(symbol) == Some(k)));
            Dual::moving(interpreter.value(symbol, at), slope)
        };
        interpreter.evaluate_in(Function::Outputs, value, &mut values);
        column.iter_mut().zip(&values).for_each(|(slope, value)| *slope = value.slope);
    }
}

/// What rounding may have made of each number of a function: [`System::output_errors`](crate::mechanism::System::output_errors) and
/// [`System::force_errors`](crate::mechanism::System::force_errors).
pub(super) fn errors(interpreter: &Interpreter, function: Function, at: interpret::At<'_>, errors: &mut [f64]) {
    let mut values = vec![Dual::constant(0.0); errors.len()];
    let value = |symbol: Symbol| match symbol {
        Symbol::Parameter(_) => Dual::rounded(interpreter.value(symbol, at)),
        _ => Dual::constant(interpreter.value(symbol, at)),
    };
    interpreter.evaluate_in(function, value, &mut values);
    errors.iter_mut().zip(values).for_each(|(error, value)| *error = value.error());
}

/// Fills the columns of
/// [`System::constraint_rates_by_inputs`](crate::mechanism::System::constraint_rates_by_inputs).
pub(super) fn constraint_rates_by_inputs(interpreter: &Interpreter, at: interpret::At<'_>, columns: &mut [f64]) {
    let rows = interpreter.program().constraints.len();
    let mut triples = vec![Dual::constant(0.0); 3 * rows];
    for (k, column) in columns.chunks_exact_mut(rows.max(1)).enumerate() {
        let seeded = Symbol::Input((k / 2) as u32, (k % 2) as u8);
        let value = |symbol: Symbol| {
            let slope = f64::from(u8::from(symbol == seeded));
            Dual::moving(interpreter.value(symbol, at), slope)
        };
        interpreter.evaluate_in(Function::Constraints, value, &mut triples);
        column.iter_mut().zip(triples.chunks_exact(3)).for_each(|(slope, triple)| *slope = triple[1].slope);
    }
}

impl Scalar for Dual {
    fn constant(value: DoubleDouble) -> Dual {
        Dual::constant(value.to_f64())
    }

    fn unary(function: Unary, x: Dual) -> Dual {
        match function {
            Unary::Neg => -x,
            Unary::Sqrt => x.sqrt(),
            Unary::Sin => x.sin_cos().0,
            Unary::Cos => x.sin_cos().1,
            Unary::Tan => Real::tan(x),
            Unary::Asin => x.asin(),
            Unary::Acos => x.acos(),
            Unary::Atan => x.atan(),
            Unary::Sinh => x.sinh(),
            Unary::Cosh => x.cosh(),
            Unary::Tanh => x.tanh(),
            Unary::Exp => x.exp(),
            Unary::Ln => x.ln(),
            Unary::Abs => x.abs(),
            Unary::Sign => x.sign(),
            Unary::Step => x.step(),
            Unary::Table(table) => {
                let at = |x: f64| table.at(x.into()).to_f64();
                let slope = table.derivative().map_or(0.0, |steepness| steepness.at(x.value.into()).to_f64());
                x.mapped(at(x.value), slope)
            }
        }
    }

    fn binary(operation: Binary, x: Dual, y: Dual) -> Dual {
        match operation {
            Binary::Add => x + y,
            Binary::Sub => x - y,
            Binary::Mul => x * y,
            Binary::Div => x / y,
            Binary::Pow => x.powf(y),
            Binary::Atan2 => x.atan2(y),
            Binary::Min => x.min(y),
            Binary::Max => x.max(y),
            Binary::Normal(_) => Dual::constant(f64::binary(operation, x.value, y.value)),
            Binary::Table(table) => {
                let (a, b) = (x.value.into(), y.value.into());
                let slope = |k| table.derivative(k).map_or(0.0, |slope| slope.at(a, b).to_f64());
                Dual::joined(table.at(a, b).to_f64(), [(x, slope(0)), (y, slope(1))])
            }
        }
    }
}
