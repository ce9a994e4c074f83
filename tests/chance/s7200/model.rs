//! A model of a program, statement by statement, written only from the manual: logic stack, contacts, timers, counters, flow.
//! [`boxes`](super::boxes) has the instructions that only change memory.

use std::collections::HashMap;

use super::boxes;
use super::memory::{Fault, ILLEGAL_REAL, Memory, RANGE};
use super::program::{Block, Direction, NETWORK, Operand, Program, Statement, Width};

/// Statements of a scan; a program that runs longer is of no use.
const STEPS: u32 = 20_000;

/// How a scan ended before its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halt {
    /// Fatal error: the CPU goes to STOP.
    Fatal(u16),
    /// STOP instruction.
    Stop,
    /// Too many statements.
    Endless,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Ton,
    Tonr,
    Tof,
}

#[derive(Clone, Copy, Debug)]
struct Timer {
    kind: Kind,
    /// The box had its input on when it last ran.
    input: bool,
    preset: i16,
}

/// Where control goes after a statement.
enum Next {
    On,
    To(usize),
    /// Leaves the block.
    Return,
    /// Ends the scan.
    End,
}

/// A running block.
struct Frame {
    stack: [bool; 9],
    eno: bool,
    gate: bool,
    segment: Option<Operand>,
    /// FOR statements whose body runs.
    loops: Vec<usize>,
}

impl Frame {
    fn push(&mut self, value: bool) {
        self.stack.copy_within(0..8, 1);
        self.stack[0] = value;
    }

    fn pop(&mut self) {
        self.stack.copy_within(1..9, 0);
        self.stack[8] = false;
    }
}

pub struct Model<'a> {
    program: &'a Program,
    pub memory: Memory,
    timers: HashMap<u8, Timer>,
    /// By block and statement; a counter has two.
    edges: HashMap<(usize, usize, u8), bool>,
    ticks_100_ms: u32,
    scan: u64,
    last_start: Option<u64>,
    times: [u16; 3],
    steps: u32,
}

impl<'a> Model<'a> {
    pub fn new(program: &'a Program) -> Model<'a> {
        let mut memory = Memory::new();
        for data in &program.data {
            let at = data.byte as usize;
            memory.v[at..at + data.bytes.len()].copy_from_slice(&data.bytes);
        }
        Model {
            program,
            memory,
            timers: HashMap::new(),
            edges: HashMap::new(),
            ticks_100_ms: 0,
            scan: 0,
            last_start: None,
            times: [0, u16::MAX, 0],
            steps: 0,
        }
    }

    /// A scan that starts at `now`, in milliseconds from RUN.
    pub fn scan(&mut self, inputs: &[u8], now: u64) -> Result<(), Halt> {
        self.begin(inputs, now);
        self.steps = 0;
        self.memory.l.fill(0);
        self.run(0, false).map(|_| ())
    }

    fn begin(&mut self, inputs: &[u8], now: u64) {
        let memory = &mut self.memory;
        memory.physical_inputs.copy_from_slice(inputs);
        memory.inputs.copy_from_slice(inputs);
        self.scan += 1;
        let first = self.scan == 1;
        let bits =
            [true, first, false, first, now % 60_000 >= 30_000, now % 1000 >= 500, self.scan.is_multiple_of(2), true];
        memory.sm[0] = bits.iter().rev().fold(0, |byte, &bit| byte << 1 | u8::from(bit));
        // A run-time error is shown for the rest of its scan; both transmitters are idle.
        memory.sm[4] = 0x60;
        let last = self.last_start.replace(now);
        if let Some(last) = last {
            let time = (now - last) as u16;
            self.times = [time, self.times[1].min(time), self.times[2].max(time)];
            for (at, time) in [22, 24, 26].into_iter().zip(self.times) {
                memory.sm[at..at + 2].copy_from_slice(&time.to_be_bytes());
            }
        }
        let last = last.unwrap_or(now);
        self.ticks_100_ms = (now / 100 - last / 100) as u32;
        let ticks = (now / 10 - last / 10) as u32;
        let numbers: Vec<u8> = self.timers.keys().copied().filter(|&number| is_10_ms(number)).collect();
        for number in numbers {
            self.advance(number, ticks);
        }
    }

    /// Time passes for a timer.
    fn advance(&mut self, number: u8, ticks: u32) {
        let Some(&timer) = self.timers.get(&number) else { return };
        let preset = i32::from(timer.preset);
        let current = (i32::from(self.current(number)) + ticks as i32).min(i32::from(i16::MAX));
        match timer.kind {
            Kind::Ton | Kind::Tonr if timer.input => {
                self.set_current(number, current as i16);
                self.memory.timer_bits[usize::from(number)] = current >= preset;
            }
            Kind::Tof if !timer.input && self.memory.timer_bits[usize::from(number)] => {
                self.set_current(number, current.min(preset.max(0)) as i16);
                self.memory.timer_bits[usize::from(number)] = current < preset;
            }
            Kind::Ton | Kind::Tonr | Kind::Tof => {}
        }
    }

    fn current(&self, number: u8) -> i16 {
        let at = usize::from(number) * 2;
        i16::from_be_bytes([self.memory.timer_values[at], self.memory.timer_values[at + 1]])
    }

    fn set_current(&mut self, number: u8, value: i16) {
        let at = usize::from(number) * 2;
        self.memory.timer_values[at..at + 2].copy_from_slice(&value.to_be_bytes());
    }

    /// Runs a block. True: the scan ends.
    fn run(&mut self, block: usize, top: bool) -> Result<bool, Halt> {
        let mut stack = [false; 9];
        stack[0] = top;
        let mut frame = Frame { stack, eno: false, gate: true, segment: None, loops: Vec::new() };
        let mut at = 0;
        while let Some(statement) = self.program.blocks[block].code.get(at) {
            self.steps += 1;
            if self.steps > STEPS {
                return Err(Halt::Endless);
            }
            match self.statement(&mut frame, (block, at), statement)? {
                Next::On => at += 1,
                Next::To(next) => at = next,
                Next::Return => return Ok(false),
                Next::End => return Ok(true),
            }
        }
        Ok(false)
    }

    /// A statement. In a step that is not active no power flows: its stack top is 0.
    fn statement(
        &mut self,
        frame: &mut Frame,
        (block, at): (usize, usize),
        statement: &Statement,
    ) -> Result<Next, Halt> {
        let operands = &statement.operands;
        let op = statement.op;
        if let Some(value) = self.contact(op, operands)? {
            let combine = if op.starts_with("LD") { 'L' } else { op.chars().next().unwrap_or('L') };
            match combine {
                'L' => frame.push(value),
                'A' => frame.stack[0] &= value,
                _ => frame.stack[0] |= value,
            }
            frame.stack[0] &= frame.gate;
            return Ok(Next::On);
        }
        let enabled = frame.stack[0] && frame.gate;
        let code = &self.program.blocks[block].code;
        match op {
            NETWORK | "NOP" | "LBL" => {}
            "NOT" => frame.stack[0] = !frame.stack[0] && frame.gate,
            "EU" => frame.stack[0] = self.rises((block, at, 0), frame.stack[0]),
            "ED" => {
                let old = self.edges.insert((block, at, 0), frame.stack[0]);
                frame.stack[0] = old == Some(true) && !frame.stack[0];
            }
            "ALD" | "OLD" => {
                let top = if op == "ALD" { frame.stack[0] && frame.stack[1] } else { frame.stack[0] || frame.stack[1] };
                frame.pop();
                frame.stack[0] = top;
            }
            "LPS" => frame.push(frame.stack[0]),
            "LRD" => frame.stack[0] = frame.stack[1],
            "LPP" => frame.pop(),
            "LDS" => frame.push(frame.stack[number(&operands[0])]),
            "AENO" => frame.stack[0] &= frame.eno,
            "=" | "=I" => self.memory.set_bit(&operands[0], enabled),
            "TON" | "TONR" | "TOF" => self.timer(op, operands, frame),
            "CTU" | "CTD" | "CTUD" => self.counter((block, at), op, operands, frame),
            "LSCR" => {
                frame.gate = self.memory.bit(&operands[0]);
                frame.segment = Some(operands[0].clone());
                frame.push(frame.gate);
            }
            "SCRE" => {
                frame.gate = true;
                frame.segment = None;
            }
            "SCRT" => {
                if enabled {
                    self.memory.set_bit(&operands[0], true);
                    if let Some(own) = &frame.segment {
                        self.memory.set_bit(own, false);
                    }
                }
            }
            "CSCRE" if enabled => {
                let end = code[at..].iter().position(|statement| statement.op == "SCRE").unwrap_or(0);
                return Ok(Next::To(at + end));
            }
            "JMP" if enabled => {
                let label = code.iter().position(|other| other.op == "LBL" && other.operands == *operands);
                return Ok(Next::To(label.expect("each jump has its label")));
            }
            "CRET" if enabled => return Ok(Next::Return),
            "END" if enabled => return Ok(Next::End),
            "STOP" if enabled => return Err(Halt::Stop),
            "CSCRE" | "JMP" | "CRET" | "END" | "STOP" => {}
            "FOR" => {
                let runs = if enabled { self.begin_loop(operands) } else { Ok(false) };
                frame.eno = enabled && runs.is_ok();
                match runs {
                    Ok(true) => frame.loops.push(at),
                    Ok(false) => return Ok(Next::To(matching_next(code, at) + 1)),
                    Err(fault) => {
                        self.report(fault);
                        return Ok(Next::To(matching_next(code, at) + 1));
                    }
                }
            }
            "NEXT" => {
                frame.stack[0] = true;
                let Some(head) = frame.loops.pop() else { return Ok(Next::On) };
                match self.again(&code[head].operands) {
                    Ok(true) => {
                        frame.loops.push(head);
                        return Ok(Next::To(head + 1));
                    }
                    Ok(false) => {}
                    Err(fault) => self.report(fault),
                }
            }
            "CALL" => {
                frame.eno = false;
                if enabled {
                    match self.call(operands)? {
                        Ok(true) => return Ok(Next::End),
                        Ok(false) => frame.eno = true,
                        Err(fault) => self.report(fault),
                    }
                }
            }
            _ => {
                frame.eno = false;
                if enabled {
                    match boxes::execute(&mut self.memory, op, operands, |number| forget(&mut self.timers, number)) {
                        Ok(()) => frame.eno = true,
                        Err(fault) => self.report(fault),
                    }
                }
            }
        }
        Ok(Next::On)
    }

    /// A run-time programming error is shown in SM4.3.
    fn report(&mut self, fault: Fault) {
        match fault {
            Fault::Run(_) => self.memory.sm[4] |= 0x08,
            Fault::Eno => {}
        }
    }

    /// FOR: whether the body runs.
    fn begin_loop(&mut self, operands: &[Operand]) -> Result<bool, Fault> {
        let initial = self.memory.read(&operands[1], Width::Word)?;
        let last = self.memory.read(&operands[2], Width::Word)?;
        let index = self.memory.place(&operands[0], 2)?;
        self.memory.set(index, Width::Word, initial);
        Ok(initial as i16 <= last as i16)
    }

    /// NEXT: whether the body runs again. The index is counted, then compared; at 32767 it stays.
    fn again(&mut self, operands: &[Operand]) -> Result<bool, Fault> {
        let place = self.memory.place(&operands[0], 2)?;
        let last = self.memory.read(&operands[2], Width::Word)? as i16;
        let index = self.memory.get(place, Width::Word) as i16;
        let Some(next) = index.checked_add(1) else { return Ok(false) };
        self.memory.set(place, Width::Word, next as u16 as u32);
        Ok(next <= last)
    }

    fn rises(&mut self, key: (usize, usize, u8), value: bool) -> bool {
        self.edges.insert(key, value) == Some(false) && value
    }

    fn int(&self, operand: &Operand) -> i16 {
        self.memory.read(operand, Width::Word).unwrap_or(0) as i16
    }

    fn set_int(&mut self, operand: &Operand, value: i16) {
        if let Ok(place) = self.memory.place(operand, 2) {
            self.memory.set(place, Width::Word, value as u16 as u32);
        }
    }

    /// The bit of a contact: `LD`, `AN`, `OW>=`; `None` for other statements.
    fn contact(&mut self, op: &str, operands: &[Operand]) -> Result<Option<bool>, Halt> {
        match op {
            "LD" | "A" | "O" => return Ok(Some(self.memory.bit(&operands[0]))),
            "LDN" | "AN" | "ON" => return Ok(Some(!self.memory.bit(&operands[0]))),
            "LDI" | "AI" | "OI" | "LDNI" | "ANI" | "ONI" => {
                let Operand::Bit(_, byte, bit) = operands[0] else { unreachable!("{op} reads an input") };
                let value = self.memory.physical_inputs[byte as usize] >> bit & 1 == 1;
                return Ok(Some(value != op.contains('N')));
            }
            _ => {}
        }
        let Some(rest) = op.strip_prefix("LD").or(op.strip_prefix('A')).or(op.strip_prefix('O')) else {
            return Ok(None);
        };
        let mut letters = rest.chars();
        let (Some(letter), relation) = (letters.next(), letters.as_str()) else { return Ok(None) };
        if !relation.starts_with(['=', '<', '>']) {
            return Ok(None);
        }
        self.compare(letter, relation, operands).map(Some)
    }

    fn compare(&mut self, letter: char, relation: &str, operands: &[Operand]) -> Result<bool, Halt> {
        let [left, right] = operands else { unreachable!("a comparison has two operands") };
        // A bad address in a comparison is fatal.
        let fatal = |fault| match fault {
            RANGE => Halt::Fatal(0x0014),
            Fault::Run(_) | Fault::Eno => Halt::Fatal(0x0011),
        };
        let order = match letter {
            'B' | 'W' | 'D' => {
                let width = match letter {
                    'B' => Width::Byte,
                    'W' => Width::Word,
                    _ => Width::Dword,
                };
                let value = |value: u32| match width {
                    Width::Byte => i64::from(value as u8),
                    Width::Word => i64::from(value as i16),
                    Width::Dword => i64::from(value as i32),
                };
                let left = self.memory.read(left, width).map_err(fatal)?;
                let right = self.memory.read(right, width).map_err(fatal)?;
                value(left).cmp(&value(right))
            }
            'R' => {
                let left = f32::from_bits(self.memory.read(left, Width::Dword).map_err(fatal)?);
                let right = f32::from_bits(self.memory.read(right, Width::Dword).map_err(fatal)?);
                let Some(order) = left.partial_cmp(&right) else {
                    self.report(Fault::Run(ILLEGAL_REAL));
                    return Ok(false);
                };
                order
            }
            _ => {
                let left = boxes::text(&self.memory, left).map_err(fatal)?;
                let right = boxes::text(&self.memory, right).map_err(fatal)?;
                return Ok((left == right) == (relation == "="));
            }
        };
        Ok(match relation {
            "=" => order.is_eq(),
            "<>" => order.is_ne(),
            ">=" => order.is_ge(),
            "<=" => order.is_le(),
            ">" => order.is_gt(),
            _ => order.is_lt(),
        })
    }

    fn timer(&mut self, op: &str, operands: &[Operand], frame: &Frame) {
        let Operand::Timer(number) = operands[0] else { unreachable!("{op} has a timer") };
        let kind = match op {
            "TON" => Kind::Ton,
            "TONR" => Kind::Tonr,
            _ => Kind::Tof,
        };
        let preset = self.int(&operands[1]);
        let input = frame.stack[0] && frame.gate;
        let before = self.timers.get(&number).is_some_and(|timer| timer.input);
        self.timers.insert(number, Timer { kind, input, preset });
        let bit = usize::from(number);
        let passed = if input != before { 0 } else { self.ticks_100_ms };
        match (kind, input) {
            // Updated when the scan began.
            (Kind::Ton | Kind::Tonr, true) | (Kind::Tof, false)
                if is_10_ms(number) && input == before && frame.gate => {}
            (Kind::Ton | Kind::Tonr, true) => self.advance(number, passed),
            (Kind::Ton, false) => {
                self.set_current(number, 0);
                self.memory.timer_bits[bit] = false;
            }
            (Kind::Tonr, false) => {}
            (Kind::Tof, true) => {
                self.set_current(number, 0);
                self.memory.timer_bits[bit] = true;
            }
            (Kind::Tof, false) if !frame.gate => {
                self.set_current(number, 0);
                self.memory.timer_bits[bit] = false;
            }
            (Kind::Tof, false) => self.advance(number, passed),
        }
    }

    fn counter(&mut self, (block, at): (usize, usize), op: &str, operands: &[Operand], frame: &Frame) {
        let Operand::Counter(number) = operands[0] else { unreachable!("{op} has a counter") };
        let preset = self.int(&operands[1]);
        let level = |level: usize| frame.stack[level] && frame.gate;
        let reset = level(0);
        let first = self.rises((block, at, 0), level(1));
        let second = op == "CTUD" && self.rises((block, at, 1), level(2));
        let place = Operand::Counter(number);
        let mut current = self.int(&place);
        let bit;
        match op {
            "CTU" if reset => (current, bit) = (0, false),
            "CTU" => {
                current = if first { current.saturating_add(1) } else { current };
                bit = current >= preset;
            }
            "CTD" if reset => (current, bit) = (preset, false),
            "CTD" => {
                current = if first && current > 0 { current - 1 } else { current };
                bit = current == 0;
            }
            _ if reset => (current, bit) = (0, false),
            _ => {
                current = current.wrapping_add(i16::from(second)).wrapping_sub(i16::from(first));
                bit = current >= preset;
            }
        }
        self.set_int(&place, current);
        self.memory.counter_bits[usize::from(number)] = bit;
    }

    /// CALL with its parameters. True: the scan ends.
    fn call(&mut self, operands: &[Operand]) -> Result<Result<bool, Fault>, Halt> {
        let Operand::Block(callee) = operands[0] else { unreachable!("a call names its block") };
        let callee = &self.program.blocks[callee + 1];
        let local = match self.copied_in(callee, &operands[1..]) {
            Ok(local) => local,
            Err(fault) => return Ok(Err(fault)),
        };
        let own = std::mem::replace(&mut self.memory.l, local);
        let Operand::Block(number) = operands[0] else { unreachable!("a call names its block") };
        let ended = self.run(number + 1, true)?;
        let local = std::mem::replace(&mut self.memory.l, own);
        for ((parameter, place), actual) in callee.parameters.iter().zip(callee.places()).zip(&operands[1..]) {
            if parameter.direction == Direction::In {
                continue;
            }
            let own = std::mem::replace(&mut self.memory.l, local.clone());
            let (bit, value) = match parameter.width {
                None => (self.memory.bit(&place), 0),
                Some(width) => (false, self.memory.read(&place, width).unwrap_or(0)),
            };
            self.memory.l = own;
            match parameter.width {
                None => self.memory.set_bit(actual, bit),
                Some(width) => {
                    if let Ok(place) = self.memory.place(actual, width.bytes()) {
                        self.memory.set(place, width, value);
                    }
                }
            }
        }
        Ok(Ok(ended))
    }

    fn copied_in(&self, callee: &Block, actuals: &[Operand]) -> Result<Vec<u8>, Fault> {
        let mut local = Memory::new();
        for ((parameter, place), actual) in callee.parameters.iter().zip(callee.places()).zip(actuals) {
            match parameter.width {
                _ if parameter.direction == Direction::Out => {}
                None => {
                    let value = match actual {
                        Operand::Number(value) => *value != 0,
                        _ => self.memory.bit(actual),
                    };
                    local.set_bit(&place, value);
                }
                Some(width) => {
                    let value = self.memory.read(actual, width)?;
                    local.set(local.place(&place, width.bytes())?, width, value);
                }
            }
        }
        Ok(local.l)
    }
}

/// `R` of a timer: it is off until its box runs again.
fn forget(timers: &mut HashMap<u8, Timer>, number: u8) {
    if let Some(timer) = timers.get_mut(&number) {
        timer.input = false;
    }
}

/// Resolution of a timer, which is 10 ms or 100 ms here.
pub fn is_10_ms(number: u8) -> bool {
    matches!(number, 1..=4 | 65..=68 | 33..=36 | 97..=100)
}

/// The NEXT of a FOR.
fn matching_next(code: &[Statement], head: usize) -> usize {
    let mut depth = 0;
    for (at, statement) in code.iter().enumerate().skip(head) {
        match statement.op {
            "FOR" => depth += 1,
            "NEXT" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at;
        }
    }
    code.len()
}

fn number(operand: &Operand) -> usize {
    match operand {
        Operand::Number(value) => *value as usize,
        _ => unreachable!("{operand} is a number"),
    }
}
