//! What binding found out and an editor shows: types and addresses; and the functions of SCL.

use plcc_model::layout;
use plcc_model::types::{DataType, Member};
use plcc_model::{Direction, Program};
use plcc_stdlib::{BlockClass, SystemBlock};
use plcc_syntax::Elementary;

/// Blocks and data with their addresses.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    pub blocks: Vec<BlockFacts>,
    pub data: Vec<DataFacts>,
    /// The functions of SCL.
    pub functions: Vec<FunctionFacts>,
}

/// The interface of a block.
#[derive(Clone, Debug)]
pub struct BlockFacts {
    /// Empty if it has none.
    pub name: String,
    /// `FB 10`
    pub key: String,
    pub parameters: Vec<ParameterFacts>,
    /// Of an FB: where its variables are in the instance.
    pub instance: Vec<Value>,
}

/// A function of SCL.
#[derive(Clone, Debug)]
pub struct FunctionFacts {
    pub name: String,
    pub parameters: Vec<ParameterFacts>,
    /// The name may carry a type: `LIMIT_INT`.
    pub is_typed: bool,
    /// What it does; empty: its name says so.
    pub description: String,
}

/// A parameter of a block or a function.
#[derive(Clone, Debug, Default)]
pub struct ParameterFacts {
    pub name: String,
    /// Other spellings of the name.
    pub also: Vec<String>,
    pub direction: &'static str,
    /// Empty: each that fits.
    pub ty: String,
    /// Others with the next numbers may follow: IN1, IN2, …
    pub is_numbered: bool,
    pub is_optional: bool,
}

impl ParameterFacts {
    /// `speed : INT IN`; of functions `IN`, `IN1 …`, `Q OUT`.
    pub fn text(&self) -> String {
        let more = if self.is_numbered { " …" } else { "" };
        match (self.ty.as_str(), self.direction) {
            ("", "IN") => format!("{}{more}", self.name),
            ("", direction) => format!("{}{more} {direction}", self.name),
            (ty, direction) => format!("{}{more} : {ty} {direction}", self.name),
        }
    }

    /// Whether it, or one of its numbers, has this name.
    pub fn is_called(&self, name: &str) -> bool {
        if self.is_numbered {
            let stem = |name: &str| name.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
            return name.ends_with(|c: char| c.is_ascii_digit()) && same(&stem(name), &stem(&self.name));
        }
        same(&self.name, name) || self.also.iter().any(|own| same(own, name))
    }

    /// Its name, or the next of its numbers, in a call that has some parameters already.
    pub fn name_after(&self, given: &[&str]) -> Option<String> {
        let is_given = |name: &str| given.iter().any(|own| same(own, name));
        if !self.is_numbered {
            return (!given.iter().any(|own| self.is_called(own))).then(|| self.name.clone());
        }
        let stem = self.name.trim_end_matches(|c: char| c.is_ascii_digit());
        let first: usize = self.name[stem.len()..].parse().ok()?;
        (first..=first + given.len()).map(|number| format!("{stem}{number}")).find(|name| !is_given(name))
    }
}

/// A data block.
#[derive(Clone, Debug)]
pub struct DataFacts {
    pub name: String,
    pub number: u16,
    /// Of an instance: the key of its block, `SFB 4`.
    pub instance_of: String,
    pub members: Vec<Value>,
}

/// A value with its place, seen from the start of what contains it.
#[derive(Clone, Debug)]
pub struct Value {
    pub name: String,
    pub ty: String,
    pub byte: u32,
    pub bit: u8,
    pub bits: u32,
    /// Of an instance: the key of its block, `SFB 4`.
    pub instance_of: String,
    pub members: Vec<Value>,
}

/// Structures inside structures are shown up to this depth.
const DEPTH_MAX: usize = 8;

impl Facts {
    pub fn of(program: &Program) -> Facts {
        let blocks = program.blocks.iter().map(|block| BlockFacts {
            name: block.name.clone(),
            key: block.key().to_string(),
            parameters: block
                .interface
                .parameters
                .iter()
                .filter(|parameter| is_own(&block.key().to_string(), &parameter.name))
                .map(|parameter| ParameterFacts {
                    name: parameter.name.clone(),
                    direction: match parameter.direction {
                        Direction::Input => "IN",
                        Direction::Output => "OUT",
                        Direction::InOut => "IN_OUT",
                    },
                    ty: layout::type_name(&parameter.ty),
                    ..ParameterFacts::default()
                })
                .collect(),
            instance: values(&block.interface.instance, &block.key().to_string(), DEPTH_MAX),
        });
        let data = program.dbs.iter().map(|db| {
            let instance_of = db.instance_of.map(|block| block.to_string()).unwrap_or_default();
            let members = values(&db.members, &instance_of, DEPTH_MAX);
            DataFacts { name: db.name.clone(), number: db.number, instance_of, members }
        });
        Facts { blocks: blocks.collect(), data: data.collect(), functions: Vec::new() }
    }

    /// The block that is called `name`, or has the key `FC 1`.
    pub fn block(&self, name: &str) -> Option<&BlockFacts> {
        self.blocks.iter().find(|block| same(&block.name, name) || block.key == name)
    }

    /// What a block of the library does.
    pub fn description(block: &BlockFacts) -> String {
        let number = block.key.rsplit(' ').next().and_then(|number| number.parse::<u16>().ok());
        let is_tia = block.key.starts_with("SF") && number >= Some(plcc_stdlib::TIA_NUMBERS);
        let found = match is_tia {
            true => plcc_stdlib::find_tia(&block.name),
            false => plcc_stdlib::find_name(&block.name),
        };
        found.map(SystemBlock::description).unwrap_or_default()
    }

    /// The function of SCL with a name, which may carry a type.
    pub fn function(&self, name: &str) -> Option<&FunctionFacts> {
        let find = |name: &str| self.functions.iter().find(|function| same(&function.name, name));
        find(name).or_else(|| {
            let (base, suffix) = name.rsplit_once('_')?;
            Elementary::from_word(&suffix.to_ascii_uppercase())?;
            find(base).filter(|function| function.is_typed)
        })
    }

    /// The data block that is called `name` or `DB1`.
    pub fn db(&self, name: &str) -> Option<&DataFacts> {
        let number = name.strip_prefix("DB").and_then(|number| number.trim().parse().ok());
        self.data.iter().find(|db| same(&db.name, name) || Some(db.number) == number)
    }
}

/// Whether two names are one: letter case does not count.
pub fn same(one: &str, other: &str) -> bool {
    !one.is_empty() && (one == other || one.to_lowercase() == other.to_lowercase())
}

/// `instance_of`: the key of the block whose instance they are, or empty.
fn values(members: &[Member], instance_of: &str, depth: usize) -> Vec<Value> {
    let value = |member: &Member| {
        let instance_of = match &member.ty {
            DataType::Struct(of) => of.instance_of.map(instance_key).unwrap_or_default(),
            _ => String::new(),
        };
        let members = match &member.ty {
            DataType::Struct(of) if depth > 0 => values(&of.members, &instance_of, depth - 1),
            _ => Vec::new(),
        };
        Value {
            name: member.name.clone(),
            ty: layout::type_name(&member.ty),
            byte: member.byte,
            bit: member.bit,
            bits: layout::used_bits(&member.ty),
            instance_of,
            members,
        }
    };
    members.iter().filter(|member| is_own(instance_of, &member.name)).map(value).collect()
}

/// Whether a name belongs to the block with that key: R of a TON is there only because all timers share a layout.
fn is_own(key: &str, name: &str) -> bool {
    let number = key.strip_prefix("SFB ").and_then(|number| number.parse().ok());
    let block = number.and_then(|number| plcc_stdlib::find(BlockClass::Sfb, number));
    !block.is_some_and(|block| plcc_stdlib::is_shared_input(block, name))
}

fn instance_key((is_system, number): (bool, u16)) -> String {
    format!("{} {number}", if is_system { "SFB" } else { "FB" })
}

/// The value at the end of a path of names, with its byte in what contains all.
pub fn find<'v>(values: &'v [Value], path: &[&str]) -> Option<(&'v Value, u32)> {
    let (first, rest) = path.split_first()?;
    let value = values.iter().find(|value| same(&value.name, first))?;
    match rest {
        [] => Some((value, value.byte)),
        rest => find(&value.members, rest).map(|(inner, byte)| (inner, byte + value.byte)),
    }
}

/// `DB10.DBW4`, for a value of so many bits.
pub fn db_address(db: u16, byte: u32, value: &Value) -> String {
    match value.bits {
        1 => format!("DB{db}.DBX{byte}.{}", value.bit),
        8 => format!("DB{db}.DBB{byte}"),
        16 => format!("DB{db}.DBW{byte}"),
        32 => format!("DB{db}.DBD{byte}"),
        bits => format!("P#DB{db}.DBX{byte}.0 BYTE {}", bits.div_ceil(8)),
    }
}
