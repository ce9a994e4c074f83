//! Variables at outputs: the block writes them itself, or they get their values when their turn comes.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::network::ast::{Pin, PinValue, Storage, Target};
use plcc_syntax::network::elements::Kind as RowKind;

use super::{Build, Origin, pin, pin_name};
use crate::plcopen::objects::{Edge, Kind, Object};
use crate::plcopen::types::Ty;

/// What a variable gets when its turn comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    Bool,
    Value,
}

impl Build<'_, '_, '_> {
    /// A variable that no block writes: a coil, or a move of another variable.
    pub(super) fn out_variable(&mut self, at: usize, object: &Object) {
        let Some(input) = object.inputs.first().filter(|input| !input.is_open()) else { return };
        // The block writes the variable itself.
        self.direct = input.from.len() == 1;
        let origins = self.sources(input);
        self.direct = false;
        let turn = match origins.as_slice() {
            [Origin::Pin(element, formal)] => self.turn(*element, formal, object),
            _ => None,
        };
        let is_plain = object.modifiers.storage == Storage::None && !object.modifiers.negated;
        let float = self.float_variable(object).filter(|_| is_plain);
        let becomes_float = float.is_some() && self.bits(input).is_some();
        if let [Origin::Pin(element, _)] = origins.as_slice()
            && !becomes_float
            && self
                .objects
                .iter()
                .enumerate()
                .any(|(block, object)| object.kind == Kind::Block && self.made.get(&block) == Some(element))
            && object.modifiers.edge == Edge::None
            && input.modifiers.edge == Edge::None
            && turn.is_none()
        {
            return self.write(at, object, origins);
        }
        let enable = match (turn, origins.as_slice()) {
            (Some(_), [Origin::Pin(element, formal)]) if !formal.eq_ignore_ascii_case("ENO") => self.enable(*element),
            _ => None,
        };
        let operand = self.operand(object);
        let value = self.input(Some(input), object.span);
        let span = object.span;
        let is_value = matches!(&value, PinValue::Operand(_)) || turn == Some(Turn::Value) || becomes_float;
        let is_kept = enable.is_some() && object.modifiers.storage == Storage::None;
        let (row, mut pins) = if is_value && is_plain || is_kept {
            let value = self.as_float(value, input, float.as_ref());
            ("Move", vec![pin("in", value, false, span), pin("out1", operand, true, span)])
        } else {
            let row = match object.modifiers.storage {
                Storage::None => "Coil",
                Storage::Set => "S_Coil",
                Storage::Reset => "R_Coil",
            };
            (row, vec![pin("in", value, false, span), pin("operand", operand, true, span)])
        };
        pins[1].negated = object.modifiers.negated;
        pins.extend(enable.filter(|_| is_kept));
        if let Some(target) = self.row(row) {
            self.element(Some(at), target, pins, span);
        }
    }

    /// EN of an element as a pin of another one, which does not run either if it is 0. Both get the signal at the turn of the first.
    fn enable(&mut self, element: usize) -> Option<Pin> {
        let is_enable = |pin: &Pin| !pin.output && pin.name.eq_ignore_ascii_case("en");
        let at = self.graph.elements[element].pins.iter().position(is_enable)?;
        let mut enable = self.graph.elements[element].pins[at].clone();
        if let PinValue::Operand(value) = enable.value.clone() {
            enable.value = PinValue::Net(self.net(vec![Origin::Operand(value, false)], enable.span));
            self.graph.elements[element].pins[at].value = enable.value.clone();
        }
        enable.name = "en".to_string();
        Some(enable)
    }

    /// What goes to a variable that an element after the block names: the variable then changes when its turn comes. None: the block
    /// writes it at once.
    fn turn(&self, element: usize, formal: &str, object: &Object) -> Option<Turn> {
        let text = object.text.clone().and_then(|range| self.reader.overlay.get(range)).unwrap_or_default();
        // An index counts, too: `cells[i]`.
        let is_named_later = words(text).any(|word| self.named.get(&word).is_some_and(|last| *last > element));
        let own = text.trim().to_lowercase();
        let is_shared = self.written.iter().any(|(by, other)| *by == element && !are_apart(&own, other));
        if !is_named_later && !is_shared {
            return None;
        }
        if object.modifiers.storage != Storage::None || formal.eq_ignore_ascii_case("ENO") {
            return Some(Turn::Bool);
        }
        if let Some(ty) = self.body.scope.types.get(&text.trim().to_lowercase()) {
            return Some(if ty.eq_ignore_ascii_case("BOOL") { Turn::Bool } else { Turn::Value });
        }
        match object.text.clone().and_then(|range| self.type_of(range)) {
            Some(Ty::Of(Elementary::Bool)) => return Some(Turn::Bool),
            Some(_) => return Some(Turn::Value),
            None => {}
        }
        let Target::Element { row, .. } = &self.graph.elements[element].target else { return None };
        let is_value = matches!(
            row.kind,
            RowKind::Operator(_)
                | RowKind::Function(_)
                | RowKind::Formula
                | RowKind::Move
                | RowKind::Convert
                | RowKind::Round(_)
                | RowKind::Negate
                | RowKind::Mux
        );
        let is_bool = matches!(row.kind, RowKind::Gate(_) | RowKind::Compare(_));
        is_bool.then_some(Turn::Bool).or(is_value.then_some(Turn::Value))
    }

    /// The output of a block goes to a variable: another pin of the block.
    fn write(&mut self, at: usize, object: &Object, origins: Vec<Origin>) {
        let Some(Origin::Pin(element, formal)) = origins.into_iter().next() else { return };
        let operand = match object.text.clone() {
            Some(range) => {
                // The element names the variable, and not one after it.
                let text = self.reader.overlay.get(range.clone()).unwrap_or_default();
                for word in words(text) {
                    let last = self.named.entry(word).or_insert(element);
                    *last = element.max(*last);
                }
                self.written.push((element, text.trim().to_lowercase()));
                PinValue::Operand(self.reader.expression(range, Some(&self.body.scope)))
            }
            None => PinValue::Open,
        };
        let canonical = self.output_name(element, &formal, object.span);
        let mut output = pin(&canonical, operand, true, object.span);
        output.storage = object.modifiers.storage;
        output.negated = object.modifiers.negated ^ self.negated_output(element, &formal);
        self.graph.elements[element].pins.push(output);
        self.made.insert(at, element);
        self.sources.entry(element).or_default().push(at);
    }

    /// The name of an output in the syntax tree; reports one that the element does not have.
    pub(super) fn output_name(&mut self, element: usize, formal: &str, span: Span) -> String {
        let Some(target) = self.graph.elements.get(element).map(|element| element.target.clone()) else {
            return formal.to_string();
        };
        let block = match &target {
            Target::Element { row, .. } => row.name,
            Target::Block { .. } => "block",
        };
        pin_name(&target, formal, true, 0)
            .or_else(|| self.unknown_pin(&target, (formal, None), block, true, span))
            .unwrap_or_else(|| formal.to_string())
    }

    /// The block has a negation circle at this output.
    pub(super) fn negated_output(&self, element: usize, formal: &str) -> bool {
        self.sources.get(&element).into_iter().flatten().any(|at| {
            let mut outputs = self.objects[*at].outputs.iter();
            outputs.any(|output| output.formal.eq_ignore_ascii_case(formal) && output.modifiers.negated)
        })
    }
}

/// The names in a text, in lower case.
pub(super) fn words(text: &str) -> impl Iterator<Item = String> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.filter(|word| word.starts_with(|c: char| !c.is_ascii_digit())).map(str::to_lowercase)
}

/// Whether two variables share no memory, and neither is an index of the other. Both in lower case.
fn are_apart(one: &str, other: &str) -> bool {
    if let (Some((array, own)), Some((same, others))) = (array_element(one), array_element(other))
        && array == same
        && own != others
    {
        return true;
    }
    if one.contains('[') || other.contains('[') {
        return words(one).all(|word| words(other).all(|own| own != word));
    }
    let is_part =
        |part: &str, whole: &str| part.strip_prefix(whole).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    !is_part(one, other) && !is_part(other, one)
}

/// The array and the indices of `cells[1, 2]`, or a component of it, if the indices are numbers.
fn array_element(text: &str) -> Option<(&str, Vec<i64>)> {
    let (array, rest) = text.split_once('[')?;
    let (indices, component) = rest.split_once(']')?;
    let indices: Option<Vec<i64>> = indices.split(',').map(|index| index.trim().parse().ok()).collect();
    indices.filter(|_| !component.contains('[')).map(|indices| (array.trim(), indices))
}
