//! A chart as source text, `.gr7`, and an OB 1 that calls it and copies its state into DB 2. Source: GRAPH reference A and E.1.

use std::fmt::{self, Display, Formatter, Write as _};

use super::chart::{
    Action, Area, Bit, Chart, Coil, Condition, Event, Input, Interface, Order, Permanent, Row, StepBit, Time,
    TransitionBit,
};
use super::generate::Call;
use super::memory::Memory;
use super::model::Model;

/// OB 1 calls the block while this byte of bit memory is 0.
pub const PAUSE: u8 = 196;
/// A word: the value of S_SEL.
pub const S_SEL: u8 = 198;
/// BOOL inputs of the block start at this byte, in the order of [`super::chart::Input::ALL`].
pub const PARAMETERS: u8 = 200;

/// Charts use C 0 and this many more.
pub const COUNTERS: u8 = 3;
/// T 0 is for TL, T 1 for TD; the others are for one TF each.
pub const TIMERS: u8 = 8;

const STEP_BITS: [StepBit; 13] = [
    StepBit::X,
    StepBit::S1,
    StepBit::S0,
    StepBit::L1,
    StepBit::L0,
    StepBit::V1,
    StepBit::V0,
    StepBit::A1,
    StepBit::R1,
    StepBit::LA,
    StepBit::VA,
    StepBit::LS,
    StepBit::VS,
];

const TRANSITION_BITS: [TransitionBit; 3] = [TransitionBit::TV, TransitionBit::TT, TransitionBit::TS];

/// A watched value in the model.
type Expected = Box<dyn Fn(&Model, &Memory) -> i64>;

/// A value that OB 1 copies into DB 2.
pub struct Watch {
    /// Its operand.
    pub name: String,
    /// Number of its first byte in DB 2.
    pub byte: u32,
    /// 1: a bit, the lowest of its byte.
    pub bits: u32,
    /// Its value in the model.
    pub value: Expected,
}

/// Everything that can be seen of an instance.
pub fn watches(chart: &Chart) -> Vec<Watch> {
    let mut list = Vec::new();
    let mut byte = 0;
    let mut add = |name: String, bits: u32, value: Expected| {
        byte += byte % 2 * u32::from(bits > 1);
        list.push(Watch { name, byte, bits, value });
        byte += bits.div_ceil(8);
    };
    for (index, step) in chart.steps.iter().enumerate() {
        let name = &step.name;
        for member in STEP_BITS {
            add(format!("DB1.{name}.{member:?}"), 1, Box::new(move |model, _| model.steps[index].bit(member).into()));
        }
        add(format!("DB1.{name}.T"), 32, Box::new(move |model, _| model.steps[index].t));
        add(format!("DB1.{name}.U"), 32, Box::new(move |model, _| model.steps[index].u));
    }
    for (index, transition) in chart.transitions.iter().enumerate() {
        for member in TRANSITION_BITS {
            let name = format!("DB1.{}.{member:?}", transition.name);
            add(name, 1, Box::new(move |model, _| model.transitions[index].bit(member).into()));
        }
    }
    if chart.interface.has(Interface::Standard) {
        add("DB1.S_NO".to_string(), 16, Box::new(|model, _| model.outputs.s_no.into()));
        add("DB1.S_ACTIVE".to_string(), 1, Box::new(|model, _| model.outputs.s_active.into()));
        add("DB1.ERR_FLT".to_string(), 1, Box::new(|model, _| model.outputs.err_flt.into()));
        add("DB1.AUTO_ON".to_string(), 1, Box::new(|model, _| model.outputs.auto_on.into()));
        add("DB1.TAP_ON".to_string(), 1, Box::new(|model, _| model.outputs.tap_on.into()));
        add("DB1.TOP_ON".to_string(), 1, Box::new(|model, _| model.outputs.top_on.into()));
        add("DB1.MAN_ON".to_string(), 1, Box::new(|model, _| model.outputs.man_on.into()));
    }
    if chart.interface.has(Interface::Maximum) {
        add("DB1.S_TIME".to_string(), 32, Box::new(|model, _| model.outputs.s_time));
        add("DB1.S_TIMEOK".to_string(), 32, Box::new(|model, _| model.outputs.s_timeok));
        add("DB1.T_NO".to_string(), 16, Box::new(|model, _| model.outputs.t_no.into()));
        add("DB1.ERROR".to_string(), 1, Box::new(|model, _| model.outputs.error.into()));
        add("DB1.FAULT".to_string(), 1, Box::new(|model, _| model.outputs.fault.into()));
        add("DB1.SQ_ISOFF".to_string(), 1, Box::new(|model, _| model.outputs.sq_isoff.into()));
        add("DB1.SQ_HALTED".to_string(), 1, Box::new(|model, _| model.outputs.sq_halted.into()));
        add("DB1.TM_HALTED".to_string(), 1, Box::new(|model, _| model.outputs.tm_halted.into()));
        add("DB1.OP_ZEROED".to_string(), 1, Box::new(|model, _| model.outputs.op_zeroed.into()));
        add("DB1.IL_ENABLED".to_string(), 1, Box::new(|model, _| model.outputs.il_enabled.into()));
        add("DB1.SV_ENABLED".to_string(), 1, Box::new(|model, _| model.outputs.sv_enabled.into()));
        add("DB1.ACKREQ_ENABLED".to_string(), 1, Box::new(|model, _| model.outputs.ackreq_enabled.into()));
        add("DB1.SSKIP_ENABLED".to_string(), 1, Box::new(|model, _| model.outputs.sskip_enabled.into()));
    }
    for bit in 0..8 {
        add(format!("DB1.v{bit}"), 1, Box::new(move |_, memory| (memory.statics[0] >> bit & 1).into()));
    }
    for counter in 0..COUNTERS {
        add(format!("C {counter}"), 16, Box::new(move |_, memory| memory.counters[usize::from(counter)].into()));
    }
    for timer in 0..TIMERS {
        add(format!("T {timer}"), 1, Box::new(move |_, memory| memory.timer(timer).into()));
    }
    list
}

/// FB 1 as `.gr7`.
pub fn graph(chart: &Chart) -> String {
    let mut out = String::new();
    print(chart, &mut out).expect("a string takes all");
    out
}

fn print(chart: &Chart, out: &mut String) -> fmt::Result {
    let flag = |value| if value { "T" } else { "F" };
    writeln!(out, "FUNCTION_BLOCK FB1")?;
    writeln!(out, "(*$_CMPSET")?;
    writeln!(out, "   FBInterface: {:?}", chart.interface)?;
    writeln!(out, "   SSBLevel: Individual")?;
    writeln!(out, "   SSkipOn: {}", flag(chart.skip))?;
    writeln!(out, "   AckReq: {}", flag(chart.acknowledge))?;
    writeln!(out, "   SaveSwitching: F")?;
    writeln!(out, "*)")?;
    writeln!(out, "VAR")?;
    (0..8).try_for_each(|bit| writeln!(out, "  v{bit} : Bool;"))?;
    writeln!(out, "END_VAR")?;
    permanent(chart, "BEGIN", &chart.before, out)?;
    for step in &chart.steps {
        let keyword = if step.initial { "INITIAL_STEP" } else { "STEP" };
        writeln!(out, "{keyword} {} (*$_NUM {}*):", step.name, step.number)?;
        for (keyword, condition) in [("INTERLOCK", &step.interlock), ("SUPERVISION", &step.supervision)] {
            if let Some(condition) = condition {
                writeln!(out, "{keyword}\n CONDITION := {}\nEND_{keyword}", Shown(chart, condition))?;
            }
        }
        for row in &step.rows {
            writeln!(out, "{}   ({})", body(chart, row), qualifier(row))?;
        }
        writeln!(out, "END_STEP")?;
    }
    for transition in &chart.transitions {
        writeln!(out, "TRANSITION {} (*$_NUM {}*)", transition.name, transition.number)?;
        writeln!(out, "  FROM {}", set(chart, &transition.from))?;
        if !transition.to.is_empty() {
            writeln!(out, "  TO {}", set(chart, &transition.to))?;
        }
        match &transition.condition {
            Some(condition) => writeln!(out, "CONDITION := {}", Shown(chart, condition))?,
            None => writeln!(out, "CONDITION :=")?,
        }
        writeln!(out, "END_TRANSITION")?;
    }
    permanent(chart, "END", &chart.after, out)?;
    writeln!(out, "END_FUNCTION_BLOCK")
}

fn permanent(chart: &Chart, place: &str, list: &[Permanent], out: &mut String) -> fmt::Result {
    if list.is_empty() {
        return Ok(());
    }
    writeln!(out, "PERM_CONDITION_AT_{place}")?;
    for Permanent { coil, operand, value } in list {
        let coil = match coil {
            Coil::Assign => "=",
            Coil::Set => "S",
            Coil::Reset => "R",
        };
        writeln!(out, "{operand} ({coil}) := {}", Shown(chart, value))?;
    }
    writeln!(out, "END_PERM_CONDITION")
}

fn set(chart: &Chart, steps: &[usize]) -> String {
    let names: Vec<&str> = steps.iter().map(|&step| chart.steps[step].name.as_str()).collect();
    if names.len() == 1 { names[0].to_string() } else { format!("( {})", names.join(", ")) }
}

fn qualifier(row: &Row) -> String {
    let instruction = match row.action {
        Action::N(_) | Action::Add { .. } | Action::Call(_) => "N",
        Action::S(_) => "S",
        Action::R(_) => "R",
        Action::D(..) => "D",
        Action::L(..) => "L",
        Action::On(_) => "ON",
        Action::Off(_) | Action::OffAll => "OFF",
        Action::CounterSet(..) => "CS",
        Action::CounterUp(_) => "CU",
        Action::CounterDown(_) => "CD",
        Action::CounterClear(_) => "CR",
        Action::TimerPulse(..) => "TL",
        Action::TimerDelay(..) => "TD",
        Action::TimerStop(_) => "TR",
        Action::TimerOff(..) => "TF",
    };
    let event = row.event.map_or(String::new(), |event: Event| format!("{event:?}_"));
    format!("{event}{instruction}{}", if row.interlock { "C" } else { "" })
}

fn body(chart: &Chart, row: &Row) -> String {
    let step = |step: usize| format!("S{:03}", chart.steps[step].number);
    let time = |time| match time {
        Time::Constant(ms) => format!("T#{ms}MS"),
        Time::Memory(byte) => format!("MD{byte}"),
    };
    match row.action {
        Action::N(bit) | Action::S(bit) | Action::R(bit) => bit.to_string(),
        Action::D(bit, t) | Action::L(bit, t) => format!("{bit} := {}", time(t)),
        Action::Add { target, source, constant } => format!("MW{target} := MW{source} + {constant}"),
        Action::Call(byte) => format!("CALL FC1 (w := MW{byte})"),
        Action::On(other) | Action::Off(other) => step(other),
        Action::OffAll => "S_ALL".to_string(),
        Action::CounterSet(counter, value) => format!("C{counter} := C#{value}"),
        Action::CounterUp(counter) | Action::CounterDown(counter) | Action::CounterClear(counter) => {
            format!("C{counter}")
        }
        Action::TimerPulse(timer, ms) | Action::TimerDelay(timer, ms) | Action::TimerOff(timer, ms) => {
            format!("T{timer} := S5T#{ms}MS")
        }
        Action::TimerStop(timer) => format!("T{timer}"),
    }
}

impl Display for Bit {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let area = match self.area {
            Area::Static => return write!(f, "#v{}", self.bit),
            Area::I => "I",
            Area::Q => "Q",
            Area::M => "M",
        };
        write!(f, "{area}{}.{}", self.byte, self.bit)
    }
}

impl Display for Order {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        f.write_str(match self {
            Order::Less => "<",
            Order::AtMost => "<=",
            Order::More => ">",
            Order::AtLeast => ">=",
            Order::Equal => "=",
            Order::Unequal => "<>",
        })
    }
}

/// A condition as text. Everything except a single operand is in parentheses.
struct Shown<'a>(&'a Chart, &'a Condition);

impl Display for Shown<'_> {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let Shown(chart, condition) = *self;
        let list = |f: &mut Formatter, operator: &str, list: &[Condition]| {
            for (index, one) in list.iter().enumerate() {
                let gap = if index == 0 { "" } else { operator };
                match one {
                    Condition::And(_) | Condition::Or(_) | Condition::Xor(_) => {
                        write!(f, "{gap}({})", Shown(chart, one))?;
                    }
                    _ => write!(f, "{gap}{}", Shown(chart, one))?,
                }
            }
            Ok(())
        };
        let step = |step: usize| format!("S{:03}", chart.steps[step].number);
        match condition {
            Condition::Constant(value) => f.write_str(if *value { "TRUE" } else { "FALSE" }),
            Condition::Bit(bit) => write!(f, "{bit}"),
            Condition::Step(index, member) => write!(f, "{}.{member:?}", step(*index)),
            Condition::Transition(index, member) => {
                write!(f, "T{:03}.{member:?}", chart.transitions[*index].number)
            }
            Condition::Time { step: index, undisturbed, order, ms } => {
                write!(f, "{}.{} {order} T#{ms}MS", step(*index), if *undisturbed { "U" } else { "T" })
            }
            Condition::Word { byte, order, value } => write!(f, "MW{byte} {order} {value}"),
            Condition::Timer(number) => write!(f, "T{number}"),
            Condition::Counter(number) => write!(f, "C{number}"),
            Condition::Not(inner) => match &**inner {
                Condition::Bit(_)
                | Condition::Timer(_)
                | Condition::Counter(_)
                | Condition::Step(..)
                | Condition::Transition(..)
                | Condition::Constant(_) => {
                    write!(f, "NOT {}", Shown(chart, inner))
                }
                _ => write!(f, "NOT ({})", Shown(chart, inner)),
            },
            Condition::And(parts) => list(f, " AND ", parts),
            Condition::Or(parts) => list(f, " OR ", parts),
            Condition::Xor(parts) => list(f, " XOR ", parts),
        }
    }
}

/// OB 1, the instance DB 1, and DB 2 with the watched values.
///
/// `long`: IL_PERM is set, which has no effect but that no call takes the short way of the ordinary modes.
pub fn caller(chart: &Chart, long: bool) -> String {
    let mut out = String::new();
    print_caller(chart, long, &mut out).expect("a string takes all");
    out
}

fn print_caller(chart: &Chart, long: bool, out: &mut String) -> fmt::Result {
    let watches = watches(chart);
    let bytes = watches.last().map_or(0, |last| last.byte + last.bits.div_ceil(8));
    writeln!(out, "DATA_BLOCK DB 1\nFB 1\nBEGIN\nEND_DATA_BLOCK")?;
    writeln!(out, "DATA_BLOCK DB 2\nSTRUCT\n  w : ARRAY [0 .. {bytes}] OF BYTE;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK")?;
    writeln!(out, "FUNCTION FC 1 : VOID\nVAR_IN_OUT\n  w : INT;\nEND_VAR\nBEGIN")?;
    writeln!(out, "      L     #w\n      +     1\n      T     #w\nEND_FUNCTION")?;
    writeln!(out, "ORGANIZATION_BLOCK OB 1\nBEGIN")?;
    writeln!(out, "      L     MB {PAUSE}\n      L     0\n      <>I\n      JC    rest")?;
    if long {
        writeln!(out, "      SET\n      =     DB1.MOP.IL_PERM")?;
    }
    let bit = |index: u32| format!("M {}.{}", u32::from(PARAMETERS) + index / 8, index % 8);
    let mut parameters: Vec<String> =
        chart.interface.inputs().map(|input| format!("{} := {}", input.name(), bit(input as u32))).collect();
    if chart.interface.has(Interface::Standard) {
        parameters.push(format!("S_SEL := MW {S_SEL}"));
    }
    writeln!(out, "      CALL  FB 1, DB 1 ({});", parameters.join(",\n        "))?;
    writeln!(out, "rest: NOP   0")?;
    for Watch { name, byte, bits, .. } in &watches {
        match bits {
            1 => writeln!(out, "      A     {name}\n      =     DB2.DBX {byte}.0")?,
            16 => writeln!(out, "      L     {name}\n      T     DB2.DBW {byte}")?,
            _ => writeln!(out, "      L     {name}\n      T     DB2.DBD {byte}")?,
        }
    }
    writeln!(out, "END_ORGANIZATION_BLOCK")
}

/// Calls as lines, for messages.
pub fn calls(calls: &[Call]) -> String {
    let mut out = String::new();
    for (index, call) in calls.iter().enumerate() {
        let inputs: Vec<&str> =
            Input::ALL.iter().filter(|&&input| call.inputs.bits[input as usize]).map(|input| input.name()).collect();
        let paused = if call.paused { " not called" } else { "" };
        let [a, b, c, d] = call.process;
        let inputs = inputs.join(" ");
        let line = format!(
            "call {}: after {} ms, IB0..3 {a:08b} {b:08b} {c:08b} {d:08b}, S_SEL {}, {inputs}{paused}\n",
            index + 1,
            call.after,
            call.inputs.s_sel
        );
        out.push_str(&line);
    }
    out
}
