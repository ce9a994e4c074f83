//! The values of a call by line of the source.

use std::collections::BTreeMap;

use plcc_diag::SourceMap;
use plcc_lower::probe::{Place, Probe};
use plcc_model::types::{Elementary, value_type};
use plcc_model::{BlockKey, Body, CodeBlock, Program};
use plcc_runtime::monitor::steps::StepSeen;
use plcc_runtime::signal;
use serde::Serialize;

use crate::recorder::{Recorder, Seen};

/// What a call has seen.
#[derive(Clone, Debug, Serialize)]
pub struct Status {
    /// `FB1`.
    pub block: String,
    pub name: String,
    pub file: String,
    pub network: Option<u16>,
    pub cycle: u64,
    /// Milliseconds since the CPU started; `None`: there was no such call.
    pub time_ms: Option<f64>,
    /// `DB1`.
    pub instance: Option<String>,
    /// The organization block first, the block itself last.
    pub path: Vec<String>,
    /// Without the chosen call: who called the block, `OB1/FB2 with DB1`; at most ten.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub calls: Vec<String>,
    /// Places that the block has, in the order of the source, whether they have run or not.
    pub places: Vec<PlaceSeen>,
    /// Of a chart.
    pub steps: Vec<StepSeen>,
}

/// A place of the source, and what it has seen.
#[derive(Clone, Debug, Serialize)]
pub struct PlaceSeen {
    /// 0: none.
    pub network: u16,
    /// From 1.
    pub line: u32,
    /// In characters, from 1.
    pub column: u32,
    /// Of its end.
    pub end_line: u32,
    /// Bytes of the file.
    pub start: u32,
    pub end: u32,
    /// What stands there.
    pub text: String,
    /// LAD and FBD: the power flow after a contact or a gate.
    pub flow: Option<bool>,
    #[serde(flatten)]
    pub kind: Kind,
}

/// What is seen at a place; `None` where the call did not come.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Kind {
    Statement {
        registers: Option<Row>,
    },
    /// A variable that is read.
    Read(Value),
    /// The result of an operation.
    Result(Value),
    /// A variable after it was written.
    Written(Value),
    /// A statement of an S7-200.
    Stack {
        levels: Option<[bool; 9]>,
        eno: Option<bool>,
        operands: Vec<(String, String)>,
    },
    /// A statement that may have no values.
    Ran {
        ran: bool,
    },
}

/// A value of a type.
#[derive(Clone, Debug, Serialize)]
pub struct Value {
    #[serde(rename = "type")]
    pub ty: String,
    pub value: Option<serde_json::Value>,
    /// As PLC languages write it.
    pub shown: Option<String>,
}

/// The registers after a statement of STL.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub rlo: bool,
    pub sta: bool,
    /// The status of the timer or counter of the statement, else ACCU1 in hexadecimal.
    pub standard: String,
    pub accu1: u32,
    pub accu2: u32,
    pub ar1: u32,
    pub ar2: u32,
    /// Numbers of the open DBs, 0: none.
    pub db1: u16,
    pub db2: u16,
    /// BR CC1 CC0 OV OS OR STA RLO /FC; the last one is bit 0.
    pub status_word: u32,
    /// The same in this order.
    pub status_bits: String,
}

/// Bits of the status word.
const RLO_BIT: u32 = 1;
const STA_BIT: u32 = 2;
const STATUS_BITS: u32 = 9;

/// Bits of a logic stack with ENO.
const ENO_BIT: u32 = 9;

fn address(key: BlockKey) -> String {
    format!("{}{}", key.kind.prefix(), key.number)
}

/// What the chosen call has seen.
pub fn status(program: &Program, sources: &SourceMap, recorder: &Recorder) -> Status {
    let choice = recorder.choice();
    let recorded = recorder.recorded();
    let block = program.block(choice.block);
    let of_block = |place: &&Place| {
        place.block == choice.block
            && place.probe != Probe::Block
            // What a chart does by itself has the place of its block.
            && block.is_none_or(|block| place.span != block.span)
            && choice.network.is_none_or(|network| place.network == network)
    };
    // A chart has code for some of its places twice, and a statement that may leave has two probes: what ran counts.
    let mut places: BTreeMap<(u32, u32, u8), (&Place, Option<&Seen>)> = BTreeMap::new();
    for (index, place) in recorder.places().iter().enumerate().filter(|(_, place)| of_block(place)) {
        let seen = recorded.as_ref().and_then(|recorded| recorded.seen.get(&(index as u32)));
        let role = match place.probe {
            Probe::Written(_) => 1,
            Probe::Ran => 2,
            _ => 0,
        };
        let entry = places.entry((place.span.start, place.span.end, role)).or_insert((place, None));
        if seen.is_some() {
            *entry = (place, seen);
        }
    }
    let mut places: Vec<PlaceSeen> =
        places.into_values().map(|(place, seen)| place_seen(sources, place, seen)).collect();
    if block.is_some_and(is_drawn) {
        note_flow(&mut places);
    }
    let file = block.map(|block| sources.file(block.span.file));
    let blocks = |path: &[u32]| -> Vec<String> {
        path.iter().filter_map(|&place| recorder.places().get(place as usize)).map(|at| address(at.block)).collect()
    };
    let call = |(path, instance): &(Vec<u32>, Option<u16>)| {
        let callers = match path.split_last().map(|(_, callers)| callers).unwrap_or_default() {
            [] => "the operating system".to_string(),
            callers => blocks(callers).join("/"),
        };
        match instance {
            Some(number) => format!("{callers} with DB{number}"),
            None => callers,
        }
    };
    let others = if recorded.is_none() { recorder.others() } else { Vec::new() };
    Status {
        block: address(choice.block),
        name: block.map(|block| block.name.clone()).unwrap_or_default(),
        file: file.map(|file| file.name.clone()).unwrap_or_default(),
        network: choice.network,
        cycle: choice.cycle,
        time_ms: recorded.as_ref().map(|recorded| recorded.time as f64 / 1e6),
        instance: recorded.as_ref().and_then(|recorded| recorded.instance).map(|number| format!("DB{number}")),
        path: recorded.as_ref().map(|recorded| blocks(&recorded.path)).unwrap_or_default(),
        calls: others.iter().map(call).collect(),
        places,
        steps: recorded.map(|recorded| recorded.steps).unwrap_or_default(),
    }
}

/// Whether the block is in LAD or FBD.
fn is_drawn(block: &CodeBlock) -> bool {
    matches!(&block.body, Body::Scl(body) if !body.networks.is_empty())
}

/// An element writes its flow to a wire, which has the place of the element.
fn note_flow(places: &mut Vec<PlaceSeen>) {
    let mut kept: Vec<PlaceSeen> = Vec::with_capacity(places.len());
    for place in places.drain(..) {
        let flow = match &place.kind {
            Kind::Written(value) if value.ty == "BOOL" => value.value.as_ref().map(|value| value.as_bool()),
            _ => None,
        };
        match (kept.last_mut(), &place.kind) {
            (Some(last), Kind::Written(value))
                if value.ty == "BOOL" && (last.start, last.end) == (place.start, place.end) =>
            {
                last.flow = flow.flatten();
            }
            _ => kept.push(place),
        }
    }
    *places = kept;
}

/// Characters of a place that are shown.
const TEXT_MAX: usize = 80;

fn place_seen(sources: &SourceMap, place: &Place, seen: Option<&Seen>) -> PlaceSeen {
    let (line, column) = sources.file(place.span.file).line_column(place.span.start);
    let words = sources.text(place.span).split_whitespace().collect::<Vec<_>>().join(" ");
    let bits = match seen {
        Some(Seen::Value(bits)) => Some(*bits),
        _ => None,
    };
    let kind = match &place.probe {
        Probe::Variable(ty) => Kind::Read(value(*ty, bits)),
        Probe::Value(ty) => Kind::Result(value(*ty, bits)),
        Probe::Written(ty) => Kind::Written(value(*ty, bits)),
        Probe::Ran => Kind::Ran { ran: bits.is_some() },
        Probe::Stack(_) => match seen {
            Some(Seen::Stack(bits, operands)) => Kind::Stack {
                levels: Some(std::array::from_fn(|level| bits >> level & 1 != 0)),
                eno: Some(bits >> ENO_BIT & 1 != 0),
                operands: operands.clone(),
            },
            _ => Kind::Stack { levels: None, eno: None, operands: Vec::new() },
        },
        Probe::Registers(_)
        | Probe::Block
        | Probe::Statement(_)
        | Probe::Formal(_)
        | Probe::Reached
        | Probe::Contact
        | Probe::Condition
        | Probe::Enable => Kind::Statement {
            registers: match seen {
                Some(Seen::Registers(registers, cell)) => Some(row(registers, cell.as_ref())),
                _ => None,
            },
        },
    };
    PlaceSeen {
        network: place.network,
        line,
        column,
        end_line: sources.file(place.span.file).line(place.span.end),
        start: place.span.start,
        end: place.span.end,
        text: words.chars().take(TEXT_MAX).collect(),
        flow: None,
        kind,
    }
}

fn value(ty: Elementary, bits: Option<u64>) -> Value {
    let seen = bits.map(|bits| signal::Value::of_type(value_type(ty), bits));
    Value {
        ty: plcc_runtime::typed::name(value_type(ty)).to_string(),
        value: seen.as_ref().map(signal::Value::json),
        shown: seen.as_ref().map(signal::Value::text),
    }
}

fn row(registers: &plcc_runtime::probe::Registers, cell: Option<&String>) -> Row {
    let bit = |number: u32| registers.status >> number & 1 != 0;
    let digits = |bits: std::ops::Range<u32>| bits.rev().map(|number| if bit(number) { '1' } else { '0' }).collect();
    let [high, middle, low]: [String; 3] = [8..STATUS_BITS, 4..8, 0..4].map(digits);
    Row {
        rlo: bit(RLO_BIT),
        sta: bit(STA_BIT),
        standard: cell.cloned().unwrap_or_else(|| format!("{:x}", registers.accu[0])),
        accu1: registers.accu[0],
        accu2: registers.accu[1],
        ar1: registers.ar[0],
        ar2: registers.ar[1],
        db1: registers.db,
        db2: registers.di,
        status_word: registers.status,
        status_bits: format!("{high}_{middle}_{low}"),
    }
}
