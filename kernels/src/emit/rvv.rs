//! RISC-V vector code (RVV 1.0) of a recorded kernel, as assembly text. No compiler stands between the tape and the instructions.
//!
//! A kernel becomes a function of four arguments: `a0`, a block of pointers; `a1`, the number of elements; `a2`, the number of the
//! first element, from 1. Its loop takes a strip of elements at a time, as many as the vector registers hold. Register 0 of the vector unit is the
//! mask of a merge, so one group of registers is lost to predicates.

use super::forms::{FORMS, Form};
use super::registers::{RegisterPool, SpillMove, Uses};
use super::{EmitError, EmittedArray, EmittedKernel, EmittedLine, GroupSize, Purpose};
use crate::backend::tape::{
    ArrayReference, Effect, Indices, Instruction, Number, Operand, PredicateInstruction, RegisterKind,
    RegisterName, Tape, TapeAction,
};
use crate::isa::{Element, Op, Storage};
use std::collections::BTreeMap;

/// Constants that stay in registers; further ones are loaded at each use, to the last two registers.
const KEPT: usize = 30;

/// Operand of an operation.
#[derive(Clone, Copy)]
enum Part<L> {
    Number(Operand<L>),
    Predicate(RegisterName),
    Index(RegisterName),
    Array(ArrayReference, bool),
    Counter(u8),
}

impl<L: Element> Part<L> {
    /// Letter in [`Form::operands`].
    fn kind(self) -> Option<char> {
        match self {
            Part::Number(Operand::Uniform(_)) => Some('f'),
            Part::Number(_) => Some('v'),
            Part::Predicate(_) => Some('p'),
            Part::Index(_) => Some('i'),
            Part::Array(reference, _) if reference.element == u32::NAME => Some('n'),
            Part::Array(..) => Some('m'),
            Part::Counter(_) => None,
        }
    }

    fn register(self) -> Option<RegisterName> {
        match self {
            Part::Number(Operand::Register(name)) | Part::Predicate(name) | Part::Index(name) => Some(name),
            Part::Number(_) | Part::Array(..) | Part::Counter(_) => None,
        }
    }
}

/// Operands of an instruction, in the order of the listing.
fn parts<L: Element>(instruction: &Instruction<L>) -> Vec<Part<L>> {
    use Part::{Array, Counter, Index, Predicate};
    let number = |operand: Operand<L>| Part::Number(operand);
    match instruction.action {
        TapeAction::Number(_, it) => match it {
            Number::Unary(_, a) => vec![number(a)],
            Number::Binary(_, a, b) => vec![number(a), number(b)],
            Number::Select(p, a, b) => vec![Predicate(p), number(a), number(b)],
            Number::Numbers => vec![],
            Number::FromIndex(i) => vec![Index(i)],
            Number::Load(from) | Number::LoadShifted(from) => vec![Array(from, false)],
            Number::Gather(from, i, elsewhere) => vec![Array(from, true), Index(i), number(elsewhere)],
        },
        TapeAction::Truth(_, it) => match it {
            PredicateInstruction::Compare(_, a, b) => vec![number(a), number(b)],
            PredicateInstruction::Connective(_, p, q) => vec![Predicate(p), Predicate(q)],
            PredicateInstruction::Negation(_, p) => vec![Predicate(p)],
        },
        TapeAction::Indices(_, it) => match it {
            Indices::ToIndex(a) => vec![number(a)],
            Indices::Load(from) => vec![Array(from, false)],
            Indices::Gather(from, i) => vec![Array(from, true), Index(i)],
        },
        TapeAction::Effect(it) => match it {
            Effect::Count(counter, p) => vec![Counter(counter), Predicate(p)],
            Effect::Store(to, a) => vec![Array(to, false), number(a)],
            Effect::StoreIndex(to, i) => vec![Array(to, false), Index(i)],
            Effect::Scatter(to, i, a) => vec![Array(to, true), Index(i), number(a)],
            Effect::ScatterIndex(to, i, j) => vec![Array(to, true), Index(i), Index(j)],
        },
    }
}

/// Emitter of one kernel.
struct Emitter {
    size: GroupSize,
    lines: Vec<EmittedLine>,
    arrays: Vec<EmittedArray>,
    constants: Vec<f64>,
    /// Pools of numbers with index vectors, and of predicates.
    pools: [RegisterPool; 2],
    /// Registers of numbers on the tape: index vectors follow them in their pool.
    numbers: usize,
    /// Places of spilled registers of the first pool; predicates follow.
    places: usize,
    /// Rows of the expansion table in use.
    forms: Vec<usize>,
    now: usize,
}

/// Writes a kernel as a function of RISC-V vector code.
///
/// # Errors
/// [`EmitError`] names an array in a precision that has no code.
pub fn emit<L: Element>(tape: &Tape<L>, size: GroupSize) -> Result<EmittedKernel, EmitError> {
    if L::NAME != f64::NAME {
        return Err(EmitError::Lane(L::NAME));
    }
    let numbers = tape.registers(RegisterKind::Number);
    let vectors = numbers + tape.registers(RegisterKind::Index);
    let predicates = tape.registers(RegisterKind::Predicate);
    let mut uses = [Uses::of(vectors), Uses::of(predicates)];
    for (at, instruction) in tape.instructions().iter().enumerate() {
        let (mut copy, mut all) = (*instruction, vec![]);
        copy.reads(|name| all.push((*name, true)));
        all.extend(instruction.to().map(|to| (to, false)));
        for (name, reads) in all {
            let (pool, home) = place(name, numbers);
            uses[pool].record(home, at, reads);
        }
    }
    let [of_vectors, of_predicates] = uses;
    let (groups, masks) = size.pools();
    let pools = [RegisterPool::of(of_vectors, groups), RegisterPool::of(of_predicates, masks)];
    let mut emitter = Emitter {
        size,
        lines: vec![],
        arrays: vec![],
        constants: vec![],
        pools,
        numbers,
        places: vectors,
        forms: vec![],
        now: 0,
    };
    for (at, instruction) in tape.instructions().iter().enumerate() {
        emitter.now = at;
        emitter.instruction(instruction)?;
    }
    Ok(emitter.finish(vectors + predicates))
}

/// Pool and number of a register of the tape in it.
fn place(name: RegisterName, numbers: usize) -> (usize, usize) {
    match name.file {
        RegisterKind::Number => (0, name.number as usize),
        RegisterKind::Index => (0, numbers + name.number as usize),
        RegisterKind::Predicate => (1, name.number as usize),
    }
}

impl Emitter {
    fn push(&mut self, purpose: Purpose, code: impl Into<String>) {
        self.lines.push(EmittedLine { code: code.into(), purpose, instruction: Some(self.now) });
    }

    /// Name of a group of a pool.
    fn name(&self, pool: usize, group: usize) -> String {
        let size = self.size.registers();
        match pool {
            0 => format!("v{}", self.size.first() + size * group),
            _ => format!("v{}", 1 + group),
        }
    }

    fn spill(&mut self, pool: usize, spills: Vec<SpillMove>) {
        for (stores, home, group) in spills {
            let place = if pool == 0 { home } else { self.places + home };
            self.push(Purpose::Spill, format!("addi t0, zero, {place}"));
            self.push(Purpose::Spill, "mul t0, t0, a7");
            self.push(Purpose::Spill, "add t0, t0, a6");
            let (name, count) = (self.name(pool, group), if pool == 0 { self.size.registers() } else { 1 });
            let code = match stores {
                true => format!("vs{count}r.v {name}, (t0)"),
                false => format!("vl{count}re8.v {name}, (t0)"),
            };
            self.push(Purpose::Spill, code);
        }
    }

    /// Scalar register of a constant. An operation has at most two of them.
    fn constant(&mut self, value: f64, is_second: bool) -> String {
        let found = self.constants.iter().position(|known| known.to_bits() == value.to_bits());
        let at = found.unwrap_or_else(|| {
            self.constants.push(value);
            self.constants.len() - 1
        });
        if at < KEPT {
            return format!("f{at}");
        }
        let register = KEPT + usize::from(is_second);
        self.push(Purpose::Address, format!("fld f{register}, {}(t3)", 8 * at));
        format!("f{register}")
    }

    /// Computes the address of an array at the own element and a shift, or of its first element.
    fn address(&mut self, reference: ArrayReference, indexed: bool) {
        let array = EmittedArray { array: reference.array, element: reference.element, indexed };
        let at = self.arrays.iter().position(|known| *known == array).unwrap_or_else(|| {
            self.arrays.push(array);
            self.arrays.len() - 1
        });
        self.push(Purpose::Address, format!("ld t2, {}(a0)", 8 * (at + super::POINTERS)));
        if indexed {
            return;
        }
        let (offset, bytes) =
            if reference.element == u32::NAME { ("a5", u32::BYTES) } else { ("a4", f64::BYTES) };
        self.push(Purpose::Address, format!("add t2, t2, {offset}"));
        let shift = reference.shift * bytes as isize;
        match shift {
            0 => {}
            -2048..=2047 => self.push(Purpose::Address, format!("addi t2, t2, {shift}")),
            _ => {
                let high = (shift + 0x800) >> 12;
                self.push(Purpose::Address, format!("lui t1, {}", high & 0xf_ffff));
                self.push(Purpose::Address, format!("addi t1, t1, {}", shift - (high << 12)));
                self.push(Purpose::Address, "add t2, t2, t1");
            }
        }
    }

    /// Emits one operation: finds its row, and fills its placeholders line by line.
    fn instruction<L: Element>(&mut self, instruction: &Instruction<L>) -> Result<(), EmitError> {
        let op = instruction.op();
        if let Some(reference) =
            instruction.reference().filter(|it| ![f64::NAME, u32::NAME].contains(&it.element))
        {
            return Err(EmitError::Precision {
                operation: op.mnemonic(),
                array: reference.array.label(),
                element: reference.element,
            });
        }
        let parts = parts(instruction);
        let mut kinds: String = parts.iter().filter_map(|part| part.kind()).collect();
        let row = |kinds: &str| FORMS.iter().position(|form| form.op == op && form.operands == kinds);
        let mut copied = None;
        if row(&kinds).is_none() {
            // The last number becomes a vector; a row with the first one as a scalar serves what is left.
            copied = kinds.rfind('f');
            let Some(at) = copied else { return Err(EmitError::NoForm(op.mnemonic())) };
            kinds.replace_range(at..=at, "v");
        }
        let at = row(&kinds).ok_or(EmitError::NoForm(op.mnemonic()))?;
        if !self.forms.contains(&at) {
            self.forms.push(at);
        }
        let form = &FORMS[at];
        let mut values = self.operands(&parts, form, copied.map(|at| at + parts.len() - kinds.len()));
        self.fill(instruction.to(), form, &mut values);
        if let [Part::Counter(number), _] = parts[..] {
            for code in [
                format!("ld t1, {}(a0)", 8 * super::COUNTERS),
                format!("ld t2, {}(t1)", 8 * number),
                "add t2, t2, t0".to_owned(),
                format!("sd t2, {}(t1)", 8 * number),
            ] {
                self.push(Purpose::Address, code);
            }
        }
        Ok(())
    }

    /// Placeholders of the operands: a register of the tape, or the text of a scalar.
    fn operands<L: Element>(
        &mut self,
        parts: &[Part<L>],
        form: &Form,
        copied: Option<usize>,
    ) -> BTreeMap<char, Value> {
        let mut values = BTreeMap::new();
        let (mut numbers, mut predicates, mut indices) = ('a'..='b', 'p'..='q', 'i'..='j');
        for part in parts {
            if let Some(name) = part.register() {
                let (pool, home) = place(name, self.numbers);
                self.pools[pool].keep(home);
            }
        }
        for (at, &part) in parts.iter().enumerate() {
            let letter = match part {
                Part::Number(_) => numbers.next(),
                Part::Predicate(_) => predicates.next(),
                Part::Index(_) => indices.next(),
                Part::Array(..) => Some('x'),
                Part::Counter(_) => None,
            };
            let Some(letter) = letter else { continue };
            let value = match part {
                Part::Number(Operand::Uniform(number)) => {
                    let scalar = self.constant(number.to_f64(), letter == 'b');
                    if copied == Some(at) { Value::Copied(scalar) } else { Value::Text(scalar) }
                }
                Part::Array(reference, indexed) => {
                    self.address(reference, indexed);
                    Value::Text("t2".to_owned())
                }
                _ => part.register().map_or(Value::Text(String::new()), |name| {
                    let (pool, home) = place(name, self.numbers);
                    Value::Tape(pool, home)
                }),
            };
            values.insert(letter, value);
        }
        if let Some(constant) = form.constant {
            let scalar = self.constant(constant, true);
            values.insert('k', Value::Text(scalar));
        }
        let scalar = match form.op {
            Op::Count => "t0",
            Op::Numbers => "a2",
            _ => "t6",
        };
        values.insert('c', Value::Text(scalar.to_owned()));
        values.insert('h', Value::Text(self.size.half().to_owned()));
        values.insert('m', Value::Text(self.size.name().to_owned()));
        values
    }

    /// Emits the lines of a row, with registers for its placeholders.
    fn fill(&mut self, to: Option<RegisterName>, form: &Form, values: &mut BTreeMap<char, Value>) {
        let result = to.map(|to| place(to, self.numbers));
        let overwritten = |pool: usize| result.filter(|(own, _)| *own == pool).map(|(_, home)| home);
        let mentions = |line: &str, letter: char| line.contains(&format!("{{{letter}}}"));
        let copies: Vec<char> =
            values.iter().filter(|(_, it)| matches!(it, Value::Copied(_))).map(|it| *it.0).collect();
        let mut bound: BTreeMap<char, (usize, usize)> = BTreeMap::new();
        for letter in copies {
            let Some(Value::Copied(scalar)) = values.get(&letter).cloned() else { continue };
            let group = self.group(0, |pool, now, spills| pool.temporary(now, spills));
            let name = self.name(0, group);
            self.push(Purpose::Expansion, format!("vfmv.v.f {name}, {scalar}"));
            bound.insert(letter, (0, group));
        }
        for (at, line) in form.code.iter().enumerate() {
            let later = |letter: char| form.code[at + 1..].iter().any(|line| mentions(line, letter));
            for (&letter, value) in values.iter() {
                if let Value::Tape(pool, home) = *value
                    && mentions(line, letter)
                    && !bound.contains_key(&letter)
                {
                    let group = self.group(pool, |it, now, spills| it.read(home, now, spills));
                    bound.insert(letter, (pool, group));
                }
            }
            for letter in ['t', 'u'] {
                if mentions(line, letter) && !bound.contains_key(&letter) {
                    let group = self.group(0, |it, now, spills| it.temporary(now, spills));
                    bound.insert(letter, (0, group));
                }
            }
            // Registers read for the last time may hold the result, unless the elements differ in size.
            let ended: Vec<char> = bound.keys().copied().filter(|&it| it != 'd' && !later(it)).collect();
            let end = |emitter: &mut Emitter, bound: &BTreeMap<char, (usize, usize)>| {
                for letter in &ended {
                    let (pool, group) = bound[letter];
                    emitter.pools[pool].release(group, emitter.now, overwritten(pool));
                }
            };
            let is_apart = mentions(line, 'D');
            if !is_apart {
                end(self, &bound);
            }
            if let Some((pool, home)) = result.filter(|_| is_apart || mentions(line, 'd'))
                && !bound.contains_key(&'d')
            {
                let group = self.group(pool, |it, now, spills| it.result(home, now, spills));
                bound.insert('d', (pool, group));
            }
            if is_apart {
                end(self, &bound);
            }
            let mut code = (*line).to_owned();
            for (letter, value) in values.iter() {
                if let Value::Text(text) = value {
                    code = code.replace(&format!("{{{letter}}}"), text);
                }
            }
            for (letter, &(pool, group)) in &bound {
                code = code.replace(&format!("{{{letter}}}"), &self.name(pool, group));
            }
            if let Some(&(pool, group)) = bound.get(&'d') {
                code = code.replace("{D}", &self.name(pool, group));
            }
            for letter in ended {
                bound.remove(&letter);
            }
            let is_last = at + 1 == form.code.len();
            self.push(if is_last { Purpose::Operation } else { Purpose::Expansion }, code);
        }
        if let (Some((pool, home)), Some(&(_, group))) = (result, bound.get(&'d')) {
            self.pools[pool].bind(home, group, self.now);
        }
    }

    /// Group of a pool, after the moves that free it.
    fn group(
        &mut self,
        pool: usize,
        find: impl FnOnce(&mut RegisterPool, usize, &mut Vec<SpillMove>) -> Option<usize>,
    ) -> usize {
        let mut spills = vec![];
        let found = find(&mut self.pools[pool], self.now, &mut spills);
        self.spill(pool, spills);
        // A row needs at most three groups at once, and every pool has as many.
        found.unwrap_or_default()
    }

    /// Adds the loop over the strips.
    fn finish(self, places: usize) -> EmittedKernel {
        let line = |code: String| EmittedLine { code, purpose: Purpose::Loop, instruction: None };
        let mut lines: Vec<EmittedLine> = vec![];
        for code in [
            "bne a1, zero, .+8".to_owned(),
            "jalr zero, 0(ra)".to_owned(),
            format!("ld t3, {}(a0)", 8 * super::CONSTANTS),
            format!("ld a6, {}(a0)", 8 * super::SPILLS),
            "csrrs a7, vlenb, zero".to_owned(),
            format!("slli a7, a7, {}", self.size.registers().ilog2()),
            "addi t6, zero, -1".to_owned(),
            "srli t6, t6, 32".to_owned(),
            "addi a4, zero, 0".to_owned(),
            "addi a5, zero, 0".to_owned(),
        ] {
            lines.push(line(code));
        }
        for at in 0..self.constants.len().min(KEPT) {
            lines.push(line(format!("fld f{at}, {}(t3)", 8 * at)));
        }
        let start = lines.len();
        lines.push(line(format!("vsetvli a3, a1, e64, {}, ta, mu", self.size.name())));
        lines.extend(self.lines);
        for code in [
            "sub a1, a1, a3",
            "add a2, a2, a3",
            "slli t0, a3, 3",
            "add a4, a4, t0",
            "slli t0, a3, 2",
            "add a5, a5, t0",
        ] {
            lines.push(line(code.to_owned()));
        }
        lines.push(line("beq a1, zero, .+8".to_owned()));
        let back = 4 * (lines.len() - start);
        lines.push(line(format!("jal zero, .-{back}")));
        lines.push(line("jalr zero, 0(ra)".to_owned()));
        EmittedKernel {
            lines,
            arrays: self.arrays,
            constants: self.constants,
            places,
            start,
            forms: self.forms,
        }
    }
}

/// Value of a placeholder.
#[derive(Clone, Debug)]
enum Value {
    Text(String),
    /// A scalar that is copied to every element of a register.
    Copied(String),
    /// A register of the tape: its pool and its number in it.
    Tape(usize, usize),
}
