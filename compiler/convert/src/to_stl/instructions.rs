//! Boxes as calls of instructions and blocks of the TIA Portal by their names: `CALL LIMIT {value_type := INT} (MN := 0, …)`.
//!
//! Source: S7-1500 information system, basic and extended instructions of STL.

use std::collections::HashMap;

use plcc_model::{Direction, InstructionPin, InstructionType};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    self, BlockName, BlockPrefix, CallType, Operand, OperandKind, Parameter, Path, PathRoot, StatementKind,
};
use plcc_syntax::literal::Literal;
use plcc_syntax::network::ast::{Element, Eno, Graph, Pin, PinValue, Storage, TemplateKey};
use plcc_syntax::network::elements::{Kind, PinDirection, Row};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::library::{pins_of_block, system_function};
use super::logic::Logic;
use super::plan::Plan;
use super::types::elementary;
use super::values::width_type;

/// A call of an instruction.
pub struct Instruction {
    name: &'static str,
    pins: Vec<InstructionPin>,
    /// It is a block of the library, which may leave BR as it is.
    is_block: bool,
    /// The number of the system function of an S7-300, which is called by it.
    number: Option<u32>,
}

/// What happens to a result after the call.
enum After {
    /// The call has written it where it belongs.
    Nothing,
    /// It is in a variable, from which it goes to the pin.
    Store { pin: String, from: Operand, ty: Elementary },
}

impl Maker<'_> {
    /// The instruction that a box is in STL; none: STL calls no such instruction.
    pub fn instruction(&self, element: &Element, row: &'static Row) -> Option<Instruction> {
        let given: Vec<&str> = connected(element).map(|pin| pin.name.as_str()).collect();
        if self.keeps_br {
            // The S7-300 has system functions instead.
            let Kind::Procedure(name) = row.kind else { return None };
            let number = Some(system_function(name)?);
            return Some(Instruction { name, pins: pins_of_block(name, &given)?, is_block: true, number });
        }
        let name = match row.kind {
            Kind::Function(name) | Kind::Procedure(name) => name,
            Kind::Round(name) if !is_float(element, TemplateKey::Destination) => name,
            Kind::Convert if has_types(element) => "CONVERT",
            Kind::Mux => "MUX",
            _ => return None,
        };
        let found = self.types.instruction(name, &given);
        let is_block = found.is_none();
        let pins = match found {
            Some(pins) => pins,
            None if self.types.is_block(name) => return None,
            None => pins_of_block(name, &given).filter(|pins| self.has_moments(element, pins))?,
        };
        let passes = |pin: &&Pin| {
            let own = row.pin(&pin.name).map(|(own, _)| own.direction);
            let there =
                pins.iter().find(|there| there.name.eq_ignore_ascii_case(&pin.name)).map(|there| there.direction);
            // STL has some inputs that networks write.
            own != Some(PinDirection::InOut) || there != Some(Direction::Input) || is_constant(pin)
        };
        connected(element).all(|pin| passes(&pin)).then_some(Instruction { name, pins, is_block, number: None })
    }

    /// The call that a box is.
    pub fn instruction_box(&mut self, graph: &Graph, plan: &Plan, at: usize, row: &Row, called: &Instruction) {
        let element = &graph.elements[at];
        let Some(types) = self.types_of_call(element, row, called) else { return };
        let bits = InstructionType::Fixed(Elementary::Bool);
        let enable = match self.input(graph, plan, at, "en") {
            // A bit that is stored for the call would take its place.
            Logic::Rlo if called.pins.iter().any(|pin| pin.ty == bits) => self.stored(&Logic::Rlo),
            enable => enable,
        };
        let mut parameters = Vec::new();
        let mut results = Vec::new();
        for pin in &called.pins {
            let actual = if element.pins.iter().any(|own| own.output && own.name.eq_ignore_ascii_case(&pin.name))
                || pin.direction == Direction::Output
            {
                self.result_of(graph, at, called, pin, &types).map(|(actual, after)| {
                    results.push(after);
                    actual
                })
            } else {
                self.input_of(graph, plan, at, pin, &types)
            };
            let Some(actual) = actual else { return };
            parameters.push(Parameter { name: pin.name.clone(), name_span: element.span, actual: Some(actual) });
        }
        let named = types.iter().map(|(word, ty)| CallType { name: format!("{word}_type"), ty: ty.name().to_string() });
        let mut named: Vec<CallType> = named.collect();
        // `src_type` before `dest_type`.
        named.sort_by(|one, other| other.name.cmp(&one.name));
        let target = match called.number {
            Some(number) => {
                let block = BlockName::Numbered { prefix: BlockPrefix::Sfc, number, span: self.span };
                Operand { kind: OperandKind::Block(block), span: self.span }
            }
            None => self.name_of(called.name),
        };
        let call = ast::Call { target, types: named, instance: None, parameters };
        let call = StatementKind::Call(Box::new(call));
        let wanted = self.is_wanted(graph, plan, at, "eno");
        if called.is_block && (wanted || self.keeps_br) && matches!(enable, Logic::Constant(true)) {
            // Elsewhere the jump sets it.
            self.push(StlInsn::SetRlo, None);
            self.push(StlInsn::Save, None);
        }
        let skip = (!matches!(enable, Logic::Constant(true))).then(|| {
            let label = self.new_label();
            self.evaluate(&enable);
            let jump = self.jump(StlInsn::JumpIfNotBr, &label);
            (label, jump)
        });
        self.sets_br = true;
        self.rlo = None;
        self.push_kind(call);
        for after in results {
            if let After::Store { pin, from, ty } = after {
                self.push(StlInsn::Load, Some(from));
                self.store_pin(graph, plan, at, &pin, ty);
            }
        }
        if wanted && element.eno == Eno::Disabled {
            self.push(StlInsn::SetRlo, None);
            self.push(StlInsn::Save, None);
            self.push(StlInsn::ClearRlo, None);
        }
        if let Some((label, jump)) = skip {
            self.clear_wires(graph, plan, at, Some(jump));
            self.label(&label);
        }
        self.take_eno(graph, plan, at, wanted);
    }

    /// The name of an instruction, in quotes where a variable of the block has it, too.
    pub fn name_of(&self, name: &str) -> Operand {
        let (name, span) = (name.to_string(), self.span);
        let mut variables = self.block.sections.iter().flat_map(|section| &section.variables);
        let root = match variables.any(|variable| variable.name.eq_ignore_ascii_case(&name)) {
            true => PathRoot::Quoted { name, span },
            false => PathRoot::Bare { name, span },
        };
        Operand { kind: OperandKind::Path(Path { root, parts: Vec::new(), span }), span }
    }

    /// The types that the call names; none after a message. Those of boxes that leave the types of their inputs are not named.
    fn types_of_call(
        &mut self,
        element: &Element,
        row: &Row,
        called: &Instruction,
    ) -> Option<HashMap<&'static str, Elementary>> {
        let mut types = HashMap::new();
        if row.typing.own_types || matches!(row.kind, Kind::Procedure(_)) {
            return Some(types);
        }
        for pin in &called.pins {
            let InstructionType::Named(word) = pin.ty else { continue };
            if types.contains_key(word) {
                continue;
            }
            let ty = match word {
                "dest" => {
                    let set = element.template(TemplateKey::Destination).and_then(|one| elementary(&one.value));
                    let set = set.or_else(|| element.pin("out").and_then(|pin| self.type_of(&pin.value)));
                    let usual = matches!(row.kind, Kind::Round(_)).then_some(Elementary::Dint);
                    let Some(ty) = set.or(usual) else {
                        self.unknown_type(element);
                        return None;
                    };
                    ty
                }
                word => {
                    let of_word = called.pins.iter().filter(|pin| pin.ty == InstructionType::Named(word));
                    let names: Vec<String> = of_word.map(|pin| pin.name.to_lowercase()).collect();
                    let names: Vec<&str> = names.iter().map(String::as_str).collect();
                    self.box_type(element, &names)?
                }
            };
            types.insert(word, ty);
        }
        if row.kind == Kind::Convert && types.get("src") == types.get("dest") {
            self.refuse(element.span, "a conversion of a type into itself", "write MOVE");
            return None;
        }
        Some(types)
    }

    /// The actual parameter for an input; none after a message.
    fn input_of(
        &mut self,
        graph: &Graph,
        plan: &Plan,
        at: usize,
        pin: &InstructionPin,
        types: &HashMap<&str, Elementary>,
    ) -> Option<Operand> {
        let element = &graph.elements[at];
        let name = pin.name.to_lowercase();
        let ty = match pin.ty {
            InstructionType::Fixed(Elementary::Bool) => {
                return match self.input(graph, plan, at, &name) {
                    Logic::Operand(operand) => Some(operand),
                    Logic::Constant(value) => Some(self.literal(Literal::Bool(value))),
                    value => match self.stored(&value) {
                        Logic::Operand(bit) => Some(bit),
                        _ => None,
                    },
                };
            }
            InstructionType::Fixed(ty) => Some(ty),
            InstructionType::Named(word) => types.get(word).copied(),
            InstructionType::Number(_) => None,
        };
        let Some(ty) = ty else { return self.own_input(element, &name, pin) };
        if ty == Elementary::Bool {
            self.refuse(element.span, "this box with BOOL", "write the network with contacts");
            return None;
        }
        let (operand, from) = self.source(graph, at, &name, ty)?;
        let as_it_is = match &operand.kind {
            // Constants of STL have 32 bits.
            OperandKind::Literal(Literal::Real(_)) if ty == Elementary::Lreal => false,
            OperandKind::Literal(Literal::Int(number)) => {
                ty != Elementary::Lreal && (i64::from(i32::MIN)..=i64::from(u32::MAX)).contains(number)
            }
            _ => from == ty,
        };
        if as_it_is {
            return Some(operand);
        }
        // The box would write a copy.
        if pin.direction == Direction::InOut && !matches!(operand.kind, OperandKind::Literal(_)) {
            let what = format!("a variable of {} that a box reads and writes as {}", from.name(), ty.name());
            self.refuse(element.span, what, "use a variable of that type");
            return None;
        }
        if ty.bits() > 32 {
            let what = format!("a value of {} as {}", from.name(), ty.name());
            self.refuse(element.span, what, "copy it into a variable of that type first");
            return None;
        }
        let load = self.load(graph, at, &name, ty)?;
        load.into_iter().for_each(|(insn, operand)| self.push(insn, operand));
        let stored = self.temporary(ty);
        self.push(StlInsn::Transfer, Some(stored.clone()));
        Some(stored)
    }

    /// An input that keeps its own type.
    fn own_input(&mut self, element: &Element, name: &str, of_call: &InstructionPin) -> Option<Operand> {
        let pin = element.pin(name);
        match pin.map(|pin| &pin.value) {
            Some(PinValue::Operand(value)) if !pin.is_some_and(|pin| pin.negated) => {
                let operand = self.operand(value)?;
                // An address would have the type of its width, and a number has none.
                let is_number = matches!(operand.kind, OperandKind::Literal(Literal::Int(_) | Literal::Bits { .. }));
                let needs_type = matches!(of_call.ty, InstructionType::Named(_));
                if width_type(&operand.kind).is_some() || (is_number && needs_type) {
                    self.unknown_type(element);
                    return None;
                }
                Some(operand)
            }
            Some(PinValue::Net(net)) if let Some((operand, _)) = self.typed.get(net) => Some(operand.clone()),
            Some(PinValue::Operand(_) | PinValue::Net(_)) => {
                self.refuse(element.span, format!("a wire with a value at `{name}`"), "put a variable between");
                None
            }
            Some(PinValue::Open) | None => {
                self.refuse(element.span, format!("a box whose input `{name}` is open"), "connect an operand");
                None
            }
        }
    }

    /// The actual parameter for a result, and what happens to it after the call; none after a message.
    fn result_of(
        &mut self,
        graph: &Graph,
        at: usize,
        called: &Instruction,
        pin: &InstructionPin,
        types: &HashMap<&str, Elementary>,
    ) -> Option<(Operand, After)> {
        let element = &graph.elements[at];
        let ty = match pin.ty {
            InstructionType::Fixed(ty) | InstructionType::Number(ty) => Some(ty),
            InstructionType::Named(word) => types.get(word).copied(),
        };
        let is_own = |own: &&Pin| own.output && own.value != PinValue::Open && own.name.eq_ignore_ascii_case(&pin.name);
        let outputs: Vec<&Pin> = element.pins.iter().filter(is_own).collect();
        if let [own] = outputs[..]
            && let PinValue::Operand(value) = &own.value
            && !own.negated
            && own.storage == Storage::None
        {
            let operand = self.operand(value)?;
            let known = self.types.of(&operand.kind, self.block);
            let fits = match ty {
                Some(ty) => {
                    known.or_else(|| width_type(&operand.kind).filter(|own| own.bits() == ty.bits()).map(|_| ty))
                        == Some(ty)
                }
                None => width_type(&operand.kind).is_none(),
            };
            if fits {
                return Some((operand, After::Nothing));
            }
        }
        // What is not written by the call must not come from a variable of another network.
        let always = !(matches!(called.name, "MUX") && element.pin("else").is_none());
        match ty.filter(|ty| (8..=32).contains(&ty.bits()) && always && pin.direction == Direction::Output) {
            Some(ty) => {
                let from = self.temporary(ty);
                Some((from.clone(), After::Store { pin: pin.name.to_lowercase(), from, ty }))
            }
            None => {
                let what = format!("the output `{}` of `{}` here", pin.name, called.name);
                self.refuse(element.span, what, "connect one variable of its type");
                None
            }
        }
    }

    fn literal(&self, value: Literal) -> Operand {
        Operand { kind: OperandKind::Literal(value), span: self.span }
    }
}

/// Pins of a box to which something is connected, without EN and ENO.
fn connected(element: &Element) -> impl Iterator<Item = &Pin> {
    element.pins.iter().filter(|pin| pin.value != PinValue::Open && !matches!(pin.name.as_str(), "en" | "eno"))
}

fn is_constant(pin: &Pin) -> bool {
    matches!(&pin.value, PinValue::Operand(value) if crate::operand::constant(value).is_some())
}

/// A setting is a floating-point type.
fn is_float(element: &Element, key: TemplateKey) -> bool {
    let ty = element.template(key).and_then(|template| elementary(&template.value));
    matches!(ty, Some(Elementary::Real | Elementary::Lreal))
}

/// The settings of a conversion name no type that only networks have: BCD16.
fn has_types(element: &Element) -> bool {
    [TemplateKey::Source, TemplateKey::Destination].iter().all(|key| {
        element.template(*key).is_none_or(|one| one.value.trim().is_empty() || elementary(&one.value).is_some())
    })
}
