//! Kernels made at run time, as lists of operations: those that another language records by calling a function on symbols.

use super::OwnKernel;
use super::arrays::{Declarations, ReadSlot, ShiftedSlot, WriteSlot};
use super::machine::OwnMachine;
use crate::isa::op::{BinaryOp, CompareOp, ConnectiveOp, NegationOp, UnaryOp};
use crate::isa::{Machine, Vector};
use serde::{Deserialize, Serialize};

/// A node of a traced kernel; operands are the numbers of nodes before it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TracedNode {
    /// An input array at a shift.
    Input(usize, isize),
    /// A broadcast number.
    Constant(f64),
    /// The element numbers, from 1.
    Numbers,
    /// A number from one.
    Unary(UnaryOp, usize),
    /// A number from two.
    Binary(BinaryOp, usize, usize),
    /// A predicate from two numbers.
    Compare(CompareOp, usize, usize),
    /// A predicate from two.
    Connective(ConnectiveOp, usize, usize),
    /// A predicate from one.
    Negation(NegationOp, usize),
    /// A merge: predicate, number where it holds, number elsewhere.
    Select(usize, usize, usize),
}

impl TracedNode {
    fn is_predicate(self) -> bool {
        matches!(self, TracedNode::Compare(..) | TracedNode::Connective(..) | TracedNode::Negation(..))
    }

    /// Operands, each with true if it must be a predicate.
    fn operands(self) -> Vec<(usize, bool)> {
        match self {
            TracedNode::Input(..) | TracedNode::Constant(_) | TracedNode::Numbers => vec![],
            TracedNode::Unary(_, a) => vec![(a, false)],
            TracedNode::Binary(_, a, b) | TracedNode::Compare(_, a, b) => vec![(a, false), (b, false)],
            TracedNode::Connective(_, p, q) => vec![(p, true), (q, true)],
            TracedNode::Negation(_, p) => vec![(p, true)],
            TracedNode::Select(p, a, b) => vec![(p, true), (a, false), (b, false)],
        }
    }
}

/// Reasons why a list of nodes is no kernel.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// A node reads a node that does not precede it, or an input that does not exist.
    #[error("node {0} reads a node or an input that does not exist")]
    Missing(usize),
    /// A node reads a truth value where it needs a number, or the reverse.
    #[error("node {0} reads a truth value where it needs a number, or a number where it needs a truth value")]
    Kind(usize),
    /// Two arrays have one name.
    #[error("two inputs or outputs are named `{0}`; give each a name of its own")]
    Name(String),
    /// No output.
    #[error("the function returns nothing; return a vector or a tuple of vectors")]
    NoOutput,
}

/// A kernel as a list of operations. As JSON: `{"inputs": ["x"], "nodes": [{"input": [0, 0]}, {"unary": ["square_root", 0]}], "outputs": [["out", 1]]}`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UncheckedKernel")]
pub struct TracedKernel {
    inputs: Vec<String>,
    nodes: Vec<TracedNode>,
    outputs: Vec<(String, usize)>,
}

/// A list of operations as read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct UncheckedKernel {
    inputs: Vec<String>,
    nodes: Vec<TracedNode>,
    outputs: Vec<(String, usize)>,
}

impl TryFrom<UncheckedKernel> for TracedKernel {
    type Error = TraceError;

    fn try_from(UncheckedKernel { inputs, nodes, outputs }: UncheckedKernel) -> Result<Self, TraceError> {
        TracedKernel::new(inputs, nodes, outputs)
    }
}

impl TracedKernel {
    /// Checks a list of nodes. Inputs and outputs have names; an output is the number of its node.
    ///
    /// # Errors
    /// [`TraceError`] names the first node that cannot be executed.
    pub fn new(
        inputs: Vec<String>,
        nodes: Vec<TracedNode>,
        outputs: Vec<(String, usize)>,
    ) -> Result<TracedKernel, TraceError> {
        for (at, node) in nodes.iter().enumerate() {
            if matches!(node, TracedNode::Input(input, _) if *input >= inputs.len()) {
                return Err(TraceError::Missing(at));
            }
            for (operand, is_predicate) in node.operands() {
                if operand >= at {
                    return Err(TraceError::Missing(at));
                }
                if nodes[operand].is_predicate() != is_predicate {
                    return Err(TraceError::Kind(at));
                }
            }
        }
        if outputs.is_empty() {
            return Err(TraceError::NoOutput);
        }
        let names: Vec<&String> = inputs.iter().chain(outputs.iter().map(|(name, _)| name)).collect();
        if let Some(at) = (1..names.len()).find(|&at| names[..at].contains(&names[at])) {
            return Err(TraceError::Name(names[at].clone()));
        }
        for &(_, at) in &outputs {
            let node = nodes.get(at).ok_or(TraceError::Missing(at))?;
            if node.is_predicate() {
                return Err(TraceError::Kind(at));
            }
        }
        Ok(TracedKernel { inputs, nodes, outputs })
    }

    /// Names of the inputs.
    pub fn inputs(&self) -> &[String] {
        &self.inputs
    }

    /// Names of the outputs.
    pub fn outputs(&self) -> impl Iterator<Item = &str> {
        self.outputs.iter().map(|(name, _)| name.as_str())
    }
}

/// Value of a node.
#[derive(Clone, Copy)]
enum NodeValue<M: Machine> {
    Number(M::V),
    Truth(M::P),
}

/// Slot of a node that loads an input; none of another node.
#[derive(Clone, Copy, Debug)]
pub enum InputSlot<'k> {
    /// The node loads nothing.
    Nothing,
    /// At the own element.
    Own(ReadSlot<'k>),
    /// At a shift.
    Shifted(ShiftedSlot<'k>),
}

impl OwnKernel for TracedKernel {
    type Lane = f64;
    /// Slots of the nodes, and of the outputs.
    type Slots<'k> = (Vec<InputSlot<'k>>, Vec<WriteSlot<'k>>);

    fn declare<'k>(&self, arrays: &mut Declarations<'k>) -> Self::Slots<'k> {
        // All inputs in their order, whether the function uses them or not.
        for name in &self.inputs {
            arrays.read(name);
        }
        let nodes = self.nodes.iter().map(|node| match *node {
            TracedNode::Input(input, 0) => InputSlot::Own(arrays.read(&self.inputs[input])),
            TracedNode::Input(input, shift) => {
                let [slot] = arrays.read_shifted(&self.inputs[input], [shift]);
                InputSlot::Shifted(slot)
            }
            _ => InputSlot::Nothing,
        });
        let nodes = nodes.collect();
        (nodes, self.outputs.iter().map(|(name, _)| arrays.write(name)).collect())
    }

    #[inline(always)]
    fn body<'k, M: Machine<Lane = f64>>(&self, m: OwnMachine<'k, M>, (inputs, outputs): &Self::Slots<'k>) {
        let mut values: Vec<NodeValue<M>> = Vec::with_capacity(self.nodes.len());
        // The kinds of operands were checked.
        let number = |values: &[NodeValue<M>], at: usize| match values[at] {
            NodeValue::Number(it) => it,
            NodeValue::Truth(_) => m.uniform(f64::NAN),
        };
        for (node, slot) in self.nodes.iter().zip(inputs) {
            let of = |at: usize| number(&values, at);
            let truth = |at: usize| match values[at] {
                NodeValue::Truth(it) => it,
                NodeValue::Number(it) => it.less_than(it),
            };
            let value = match *node {
                TracedNode::Input(..) => NodeValue::Number(match *slot {
                    InputSlot::Own(slot) => m.load(slot),
                    InputSlot::Shifted(slot) => m.load_shifted(slot),
                    InputSlot::Nothing => m.uniform(f64::NAN),
                }),
                TracedNode::Constant(value) => NodeValue::Number(m.uniform(value)),
                TracedNode::Numbers => NodeValue::Number(m.numbers()),
                TracedNode::Unary(op, a) => NodeValue::Number(op.apply(of(a))),
                TracedNode::Binary(op, a, b) => NodeValue::Number(op.apply(of(a), of(b))),
                TracedNode::Compare(op, a, b) => NodeValue::Truth(op.apply(of(a), of(b))),
                TracedNode::Connective(op, p, q) => NodeValue::Truth(op.apply(truth(p), truth(q))),
                TracedNode::Negation(op, p) => NodeValue::Truth(op.apply(truth(p))),
                TracedNode::Select(p, a, b) => NodeValue::Number(M::V::select(truth(p), of(a), of(b))),
            };
            values.push(value);
        }
        for (&(_, at), &slot) in self.outputs.iter().zip(outputs) {
            m.store(slot, number(&values, at));
        }
    }
}
