//! Random valid programs and the inputs of their scans, with values, counts and addresses at the limits of the allowed range.

mod instructions;

use super::operands::{self, Local};
use super::program::{Area, Block, Data, Direction, NETWORK, Operand, Parameter, Program, Statement, Width};
use instructions::{BOXES, COMPARISONS, RELATIONS, comparison};
use plcc_tests::random::Random;

/// The inputs of a scan.
#[derive(Clone, Debug)]
pub struct Scan {
    /// Milliseconds since the scan before.
    pub after: u64,
    pub inputs: Vec<u8>,
}

/// A program with its scans.
#[derive(Clone, Debug)]
pub struct Case {
    pub program: Program,
    pub scans: Vec<Scan>,
}

/// The case of a seed.
pub fn case(seed: u64) -> Case {
    let mut random = Random::new(seed);
    let subroutines = random.of(&[0, 0, 1, 2, 3]);
    let mut parameters: Vec<Vec<Parameter>> = vec![Vec::new()];
    (0..subroutines).for_each(|_| parameters.push(self::parameters(&mut random)));
    let mut writer = Writer {
        random,
        parameters,
        timers: (1..=255).filter(|number| number % 64 != 0 && number % 64 != 32).collect(),
        counters: (0..=255).collect(),
        labels: 0,
        steps: (0..24).collect(),
        loops: 0,
        depth: 0,
        block: 0,
        code: Vec::new(),
        local: Local::default(),
        in_step: false,
    };
    writer.timers.push(160);
    let mut blocks = Vec::new();
    for number in 0..=subroutines {
        blocks.push(writer.write_block(number));
    }
    let mut random = writer.random;
    let program = Program { blocks, data: data(&mut random) };
    let count = random.of(&[2, 4, 6, 8]);
    let scans = (0..count).map(|number| scan(&mut random, number)).collect();
    Case { program, scans }
}

fn scan(random: &mut Random, number: usize) -> Scan {
    let after = if number == 0 { 0 } else { random.of(&[0, 1, 5, 10, 37, 95, 100, 250, 1000, 31_234]) };
    Scan { after, inputs: (0..16).map(|_| random.of(&[0, 0xFF, 1, 0x80, 0x55]) ^ random.below(4) as u8).collect() }
}

fn parameters(random: &mut Random) -> Vec<Parameter> {
    let types: [(&str, Option<Width>); 7] = [
        ("BOOL", None),
        ("BYTE", Some(Width::Byte)),
        ("WORD", Some(Width::Word)),
        ("INT", Some(Width::Word)),
        ("DWORD", Some(Width::Dword)),
        ("DINT", Some(Width::Dword)),
        ("REAL", Some(Width::Dword)),
    ];
    let mut list = Vec::new();
    for direction in [Direction::In, Direction::InOut, Direction::Out] {
        for _ in 0..random.below(4) {
            let (type_name, width) = random.of(&types);
            list.push(Parameter { direction, width, type_name });
        }
    }
    list
}

/// Start values of V memory, in the parts that [`operands`] names.
fn data(random: &mut Random) -> Vec<Data> {
    let mut data = Vec::new();
    for byte in (operands::NUMBERS.start..operands::NUMBERS.end).step_by(4) {
        if random.percent(70) {
            let value = operands::edge_dword(random) as u32;
            data.push(number(byte, value));
        }
    }
    for byte in (operands::REALS.start..operands::REALS.end).step_by(4) {
        let value = match random.below(12) {
            0 => f32::NAN,
            1 => random.of(&[f32::INFINITY, f32::NEG_INFINITY]),
            _ => operands::edge_real(random),
        };
        data.push(number(byte, value.to_bits()));
    }
    for byte in operands::COUNTS {
        let value =
            random.of(&[0, 1, 1, 2, 3, 7, 8, 9, 15, 16, 17, 31, 32, 33, 63, 64, 65, 127, 128, 192, 240, 254, 255]);
        data.push(Data { byte, text: format!("VB{byte} {value}"), bytes: vec![value] });
    }
    for byte in operands::DIGITS.step_by(2) {
        let characters = [random.of(b"0123456789ABCDEFag: "), random.of(b"0123456789ABCDEF")];
        let text = String::from_utf8_lossy(&characters).into_owned();
        data.push(Data { byte, text: format!("VB{byte} '{text}'"), bytes: characters.to_vec() });
    }
    for byte in operands::TABLES {
        let most = random.of(&[0u16, 1, 3, 5, 8]);
        let count = random.below(usize::from(most) + 1) as u16;
        data.push(words(byte, &[most, count, 100, 1, 0, 0x8000, 1, 7]));
    }
    for byte in operands::STRINGS {
        let text = random.of(&["", "a", "A1,2", "-12x", " +32768", "-2147483649", "banana", "  77", "00099", "ana"]);
        let mut bytes = vec![text.len() as u8];
        bytes.extend(text.bytes());
        data.push(Data { byte, text: format!("VB{byte} \"{text}\""), bytes });
    }
    data.push(Data { byte: 10230, text: "VB10230 10, 'tail'".to_string(), bytes: b"\x0Atail".to_vec() });
    data
}

fn number(byte: u32, value: u32) -> Data {
    Data { byte, text: format!("VD{byte} 16#{value:X}"), bytes: value.to_be_bytes().to_vec() }
}

fn words(byte: u32, values: &[u16]) -> Data {
    let text: Vec<String> = values.iter().map(|value| format!("16#{value:04X}")).collect();
    Data {
        byte,
        text: format!("VW{byte} {}", text.join(", ")),
        bytes: values.iter().flat_map(|value| value.to_be_bytes()).collect(),
    }
}

/// True for a constant number of elements that do not fit.
fn leaves_area(op: &str, operands: &[Operand]) -> bool {
    let Some(Operand::Number(count)) = operands.last() else { return false };
    let count = count.unsigned_abs() as u32;
    let size = match op {
        "BMB" => 1,
        "BMW" | "FILL" => 2,
        "BMD" => 4,
        "S" | "R" | "SI" | "RI" | "SHRB" => 0,
        // Its digits: each in a byte.
        "ATH" | "HTA" => 1,
        _ => return false,
    };
    operands.iter().any(|operand| match operand {
        Operand::Bit(area, byte, bit) => size == 0 && byte * 8 + u32::from(*bit) + count > area.bytes() * 8,
        Operand::Cell(area, _, byte) => byte + size * count > area.bytes(),
        Operand::Timer(number) | Operand::Counter(number) => u32::from(*number) + count > 256,
        _ => false,
    })
}

struct Writer {
    random: Random,
    parameters: Vec<Vec<Parameter>>,
    /// Numbers that no box has yet.
    timers: Vec<u8>,
    counters: Vec<u8>,
    labels: i64,
    steps: Vec<u32>,
    loops: u32,
    depth: usize,
    block: usize,
    code: Vec<Statement>,
    local: Local,
    in_step: bool,
}

impl Writer {
    fn write_block(&mut self, number: usize) -> Block {
        self.block = number;
        self.code = Vec::new();
        let parameters = self.parameters[number].clone();
        let block = Block { parameters, code: Vec::new() };
        self.local = Local::of(&block);
        if number == 0 {
            self.pointers();
        }
        for _ in 0..2 + self.random.below(8) {
            self.piece();
        }
        Block { code: std::mem::take(&mut self.code), ..block }
    }

    fn add(&mut self, op: &'static str, operands: Vec<Operand>) {
        self.code.push(Statement { op, operands });
    }

    /// Pointers and the first steps of the first scan.
    fn pointers(&mut self) {
        self.add(NETWORK, Vec::new());
        self.add("LD", vec![Operand::Bit(Area::Sm, 0, 1)]);
        for pointer in operands::POINTERS.step_by(4) {
            let target = match self.random.below(8) {
                0 => Operand::Number(self.random.of(&[0, 1, 0x0800_27FF, 0x0800_2800, 0x0700_0000, 0x0A00_01FF, -1])),
                _ => Operand::AddressOf(Box::new(operands::target(&mut self.random))),
            };
            self.add("MOVD", vec![target, Operand::Cell(Area::V, Width::Dword, pointer)]);
        }
        for accumulator in 1..=3 {
            if self.random.percent(60) {
                let target = Operand::AddressOf(Box::new(operands::target(&mut self.random)));
                self.add("MOVD", vec![target, Operand::Accumulator(accumulator)]);
            }
        }
        self.add("S", vec![Operand::Bit(Area::S, 0, 0), Operand::Number(3)]);
    }

    fn piece(&mut self) {
        match self.random.below(20) {
            0 if self.depth < 3 => self.repeat(),
            1 if self.depth < 3 => self.skip(),
            2 | 3 if self.depth == 0 && !self.in_step => self.step(),
            4 if self.block + 1 < self.parameters.len() => self.call(),
            5 if !self.in_step && self.random.percent(20) => self.leave(),
            _ => self.network(),
        }
    }

    fn pieces(&mut self) {
        self.depth += 1;
        for _ in 0..1 + self.random.below(3) {
            self.piece();
        }
        self.depth -= 1;
    }

    fn repeat(&mut self) {
        let index = Operand::Cell(Area::V, Width::Word, operands::INDEXES + 2 * self.loops);
        self.loops += 1;
        let (first, last) =
            self.random.of(&[(1, 3), (0, 0), (2, 1), (-2, 1), (32766, 32767), (-32768, -32767), (1, 5)]);
        let last = match self.random.below(8) {
            0 => operands::operand(&mut self.random, 'w', &self.local),
            _ => Operand::Number(last),
        };
        self.condition();
        self.add("FOR", vec![index, Operand::Number(first), last]);
        self.pieces();
        self.add(NETWORK, Vec::new());
        self.add("NEXT", Vec::new());
    }

    fn skip(&mut self) {
        let label = Operand::Number(self.labels);
        self.labels += 1;
        self.condition();
        self.add("JMP", vec![label.clone()]);
        self.pieces();
        self.add(NETWORK, Vec::new());
        self.add("LBL", vec![label]);
    }

    fn step(&mut self) {
        let Some(number) = (!self.steps.is_empty()).then(|| self.steps.remove(0)) else { return };
        let bit = |number: u32| Operand::Bit(Area::S, number / 8, (number % 8) as u8);
        self.in_step = true;
        self.add(NETWORK, Vec::new());
        self.add("LSCR", vec![bit(number)]);
        self.pieces();
        if self.random.percent(50) {
            self.condition();
            let next = (number + 1 + self.random.below(3) as u32) % 24;
            self.add("SCRT", vec![bit(next)]);
        }
        if self.random.percent(20) {
            self.condition();
            self.add("CSCRE", Vec::new());
            self.pieces();
        }
        self.add(NETWORK, Vec::new());
        self.add("SCRE", Vec::new());
        self.in_step = false;
    }

    fn leave(&mut self) {
        self.condition();
        match (self.block, self.random.below(6)) {
            (_, 0) => self.add("STOP", Vec::new()),
            (0, _) => self.add("END", Vec::new()),
            _ => self.add("CRET", Vec::new()),
        }
    }

    fn call(&mut self) {
        self.condition();
        let callee = self.block + 1 + self.random.below(self.parameters.len() - self.block - 1);
        let mut actuals = vec![Operand::Block(callee - 1)];
        for parameter in self.parameters[callee].clone() {
            let letter = match (parameter.direction, parameter.width, parameter.type_name) {
                (_, None, _) => 'X',
                (Direction::In, Some(Width::Byte), _) => 'b',
                (Direction::In, Some(Width::Word), _) => 'w',
                (Direction::In, Some(Width::Dword), "REAL") => 'r',
                (Direction::In, Some(Width::Dword), _) => 'd',
                (_, Some(Width::Byte), _) => 'E',
                (_, Some(Width::Word), _) => 'F',
                (_, Some(Width::Dword), _) => 'G',
            };
            actuals.push(operands::operand(&mut self.random, letter, &self.local));
        }
        // A constant has the type of its parameter.
        for (actual, parameter) in actuals[1..].iter_mut().zip(&self.parameters[callee]) {
            if let Operand::Number(value) = actual {
                *value = match parameter.type_name {
                    "WORD" => *value & 0xFFFF,
                    "INT" => i64::from(*value as i16),
                    "DWORD" => *value & 0xFFFF_FFFF,
                    "DINT" => i64::from(*value as i32),
                    _ => *value,
                };
            }
        }
        self.add("CALL", actuals);
        self.eno();
    }

    /// Begins a network and leaves its condition in the stack top.
    fn condition(&mut self) {
        self.add(NETWORK, Vec::new());
        if self.random.percent(25) {
            self.add("LD", vec![Operand::Bit(Area::Sm, 0, 0)]);
        } else {
            self.contact("LD");
            for _ in 0..self.random.below(3) {
                self.more();
            }
        }
    }

    /// A contact: LD, A or O.
    fn contact(&mut self, load: &'static str) {
        if self.random.percent(25) {
            let (letter, kinds) = self.random.of(COMPARISONS);
            let relation = self.random.of(&RELATIONS);
            let list = kinds.chars().map(|kind| operands::checked(&mut self.random, kind, &self.local)).collect();
            self.add(comparison(load, letter, relation), list);
            return;
        }
        if self.random.percent(4) {
            let list = (0..2).map(|_| operands::checked(&mut self.random, 's', &self.local)).collect::<Vec<_>>();
            if !matches!(list[1], Operand::Text(_)) {
                let relation = self.random.of(&["=", "<>"]);
                self.add(comparison(load, "S", relation), list);
                return;
            }
        }
        let names = match load {
            "LD" => ["LD", "LD", "LDN", "LDI", "LDNI"],
            "A" => ["A", "A", "AN", "AI", "ANI"],
            _ => ["O", "O", "ON", "OI", "ONI"],
        };
        let op = self.random.of(&names);
        let bit = match op.ends_with('I') {
            true => Operand::Bit(Area::I, self.random.below(16) as u32, self.random.below(8) as u8),
            false => operands::operand(&mut self.random, 'x', &self.local),
        };
        self.add(op, vec![bit]);
    }

    /// Statements that need a level and leave as many.
    fn more(&mut self) {
        match self.random.below(12) {
            0..=2 => self.contact("A"),
            3..=5 => self.contact("O"),
            6 => self.add("NOT", Vec::new()),
            7 => self.add("EU", Vec::new()),
            8 => self.add("ED", Vec::new()),
            9 => {
                self.contact("LD");
                self.contact("A");
                let op = self.random.of(&["ALD", "OLD"]);
                self.add(op, Vec::new());
            }
            10 => {
                self.contact("LD");
                let level = self.random.below(2) as i64;
                self.add("LDS", vec![Operand::Number(level)]);
                let (first, second) = self.random.of(&[("ALD", "OLD"), ("OLD", "ALD"), ("LPP", "ALD"), ("LRD", "LPP")]);
                self.add(first, Vec::new());
                self.add(second, Vec::new());
                if first == "LRD" {
                    self.add("OLD", Vec::new());
                }
            }
            _ => {
                for _ in 0..9 {
                    self.add("LPS", Vec::new());
                }
                self.contact("A");
                for _ in 0..9 {
                    self.add("LPP", Vec::new());
                }
                // The level that was pushed out is lost.
                self.contact("O");
            }
        }
    }

    fn network(&mut self) {
        match self.random.below(12) {
            0 => return self.timer(),
            1 => return self.counter(),
            2 => return self.branches(),
            3 if !self.code.is_empty() && self.random.percent(30) => {
                // No load: the stack top does not change.
                self.add(NETWORK, Vec::new());
                return self.output();
            }
            _ => self.condition(),
        }
        for _ in 0..1 + self.random.below(4) {
            self.output();
            if self.random.percent(10) {
                self.more();
            }
        }
    }

    fn branches(&mut self) {
        self.condition();
        self.add("LPS", Vec::new());
        self.contact("A");
        self.output();
        self.add("LRD", Vec::new());
        self.contact("A");
        self.output();
        self.add("LPP", Vec::new());
        self.output();
    }

    /// A coil or a box.
    fn output(&mut self) {
        if self.random.percent(15) {
            let bit = operands::operand(&mut self.random, 'X', &self.local);
            return self.add("=", vec![bit]);
        }
        if self.random.percent(2) {
            let bit = operands::operand(&mut self.random, 'Q', &self.local);
            return self.add("=I", vec![bit]);
        }
        let (op, kinds) = self.random.of(BOXES);
        let mut list: Vec<Operand> =
            kinds.chars().map(|kind| operands::operand(&mut self.random, kind, &self.local)).collect();
        if leaves_area(op, &list) {
            // A constant range must fit; one of run time need not.
            list.pop();
            list.push(operands::operand(&mut self.random, 'p', &self.local));
        }
        self.add(op, list);
        self.eno();
    }

    /// A coil that shows ENO, now and then.
    fn eno(&mut self) {
        if self.random.percent(20) {
            self.add("AENO", Vec::new());
            let bit = operands::operand(&mut self.random, 'X', &self.local);
            self.add("=", vec![bit]);
        }
    }

    fn timer(&mut self) {
        if self.timers.is_empty() {
            return;
        }
        // Low numbers are the ones that other instructions name.
        let limit = if self.random.percent(50) { self.timers.len().min(12) } else { self.timers.len() };
        let at = self.random.below(limit);
        let number = self.timers.remove(at);
        let retentive = number < 32 || (64..96).contains(&number);
        let op = if retentive { "TONR" } else { self.random.of(&["TON", "TON", "TOF"]) };
        let preset = match (op, self.random.below(6)) {
            ("TOF", _) | (_, 0) => Operand::Number(self.random.of(&[1, 2, 3, 10, 100])),
            (_, 1) => operands::operand(&mut self.random, 'w', &self.local),
            _ => Operand::Number(self.random.of(&[1, 2, 3, 10, 25, 32767, 0, -1])),
        };
        self.condition();
        let preset = match preset {
            Operand::Pointed(_) => Operand::Number(5),
            other => other,
        };
        self.add(op, vec![Operand::Timer(number), preset]);
    }

    fn counter(&mut self) {
        let limit = if self.random.percent(50) { self.counters.len().min(4) } else { self.counters.len() };
        let at = self.random.below(limit);
        if self.counters.len() < 200 {
            return;
        }
        let number = self.counters.remove(at);
        let op = self.random.of(&["CTU", "CTD", "CTUD"]);
        self.condition();
        self.contact("LD");
        if op == "CTUD" {
            self.contact("LD");
        }
        let preset = match self.random.below(4) {
            0 => operands::checked(&mut self.random, 'w', &self.local),
            _ => Operand::Number(self.random.of(&[1, 2, 3, 0, -1, 32767, -32768])),
        };
        let preset = match preset {
            Operand::Pointed(_) => Operand::Number(2),
            other => other,
        };
        self.add(op, vec![Operand::Counter(number), preset]);
    }
}
