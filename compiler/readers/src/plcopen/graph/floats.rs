//! Bit strings at inputs for floats: they are numbers without sign, as in text.

use std::collections::HashSet;

use super::super::functions::floats;
use super::super::objects::{Connection, Edge, Kind, Object};
use super::super::types::Ty;
use super::{Build, DEPTH_MAX, FORMULA, Origin, name, pin};
use plcc_syntax::network::ast::PinValue;
use plcc_syntax::scl::ast::NameForm;

impl Build<'_, '_, '_> {
    /// The float that each input of a block needs; `own`: it is a block of the project or of the library.
    pub(super) fn floats(&self, at: usize, object: &Object, own: bool) -> Vec<Option<Ty>> {
        let types = &self.body.scope.shared.types;
        if own {
            let block = Ty::Named(object.name.to_lowercase());
            let input = |input: &Connection| types.member(&block, &input.formal.to_lowercase()).filter(Ty::is_float);
            return object.inputs.iter().map(input).collect();
        }
        let is_value = |input: &Connection| !input.formal.eq_ignore_ascii_case("EN");
        let needed = if object.name.eq_ignore_ascii_case("MOVE") {
            self.float_after(at).map(|float| (0, float))
        } else {
            let values = object.inputs.iter().filter(|&input| is_value(input));
            let kinds: Vec<Option<Ty>> = values.map(|input| self.kind(input)).collect();
            floats::inputs(&object.name, &kinds)
        };
        let mut values = 0;
        let float = |input: &Connection| {
            let place = values;
            values += usize::from(is_value(input));
            let (_, float) = needed.as_ref().filter(|(first, _)| is_value(input) && place >= *first)?;
            Some(float.clone())
        };
        object.inputs.iter().map(float).collect()
    }

    /// The type of a variable to which an object leads, if it is a float.
    fn float_after(&self, at: usize) -> Option<Ty> {
        let leads = |input: &Connection| input.from.iter().any(|(from, _)| *from == at);
        let is_reached = |object: &Object| object.kind == Kind::OutVariable && object.inputs.iter().any(leads);
        self.objects.iter().filter(|&object| is_reached(object)).find_map(|object| self.float_variable(object))
    }

    /// The type of the variable that an object names, if it is a float.
    pub(super) fn float_variable(&self, object: &Object) -> Option<Ty> {
        self.type_of(object.text.clone()?).filter(Ty::is_float)
    }

    /// The value of an input that needs a float.
    pub(super) fn as_float(&mut self, value: PinValue, input: &Connection, float: Option<&Ty>) -> PinValue {
        let Some(float) = float.filter(|_| !input.in_out && !input.modifiers.negated) else { return value };
        match value {
            PinValue::Operand(mut operand) => {
                let mut kind = self.kind(input);
                floats::of_bits(&mut operand, &mut kind, float);
                PinValue::Operand(operand)
            }
            PinValue::Net(_) => match (self.bits(input), self.row(FORMULA)) {
                (Some(bits), Some(target)) => {
                    let span = input.span;
                    let mut number = name("in1", NameForm::Bare, span);
                    floats::of_bits(&mut number, &mut Some(bits), float);
                    let element = self.element(None, target, vec![pin("in1", value, false, span)], span);
                    self.graph.elements[element].equation = Some(number);
                    PinValue::Net(self.net(vec![Origin::Pin(element, "out".to_string())], span))
                }
                _ => value,
            },
            PinValue::Open => value,
        }
    }

    /// The type of the signal at an input, if it is a bit string.
    pub(super) fn bits(&self, input: &Connection) -> Option<Ty> {
        self.bits_behind(input, &mut HashSet::new())
    }

    /// `seen`: the blocks that were looked at.
    fn bits_behind(&self, input: &Connection, seen: &mut HashSet<usize>) -> Option<Ty> {
        if input.modifiers.edge != Edge::None {
            return None;
        }
        if let Some(kind) = self.kind(input) {
            return Some(kind).filter(floats::is_bit_string);
        }
        let [(from, formal)] = input.from.as_slice() else { return None };
        let object = &self.objects[*from];
        let upper = object.name.to_ascii_uppercase();
        let keeps = object.kind == Kind::Block
            && !formal.eq_ignore_ascii_case("ENO")
            && !self.reader.pous.contains(&object.name.to_lowercase())
            && (upper != "MOVE" || self.float_after(*from).is_none())
            && seen.len() < DEPTH_MAX
            && seen.insert(*from);
        // Which inputs have the type of the output.
        let (first, last) = match upper.as_str() {
            "AND" | "OR" | "XOR" => (0, usize::MAX),
            "NOT" | "SHL" | "SHR" | "ROL" | "ROR" | "MOVE" => (0, 1),
            "SEL" | "MUX" => (1, usize::MAX),
            _ => return None,
        };
        let values = object.inputs.iter().filter(|input| !input.formal.eq_ignore_ascii_case("EN"));
        let mut values = values.take(last).skip(first).filter(|_| keeps);
        let has_float = values.clone().any(|value| self.kind(value).is_some_and(|kind| kind.is_float()));
        values.find_map(|value| self.bits_behind(value, seen)).filter(|_| !has_float)
    }
}
