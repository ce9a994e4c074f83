//! Bit strings at inputs for floats: they are numbers without sign, as in text.

use super::super::functions::floats;
use super::super::objects::{Connection, Kind, Object};
use super::super::types::Ty;
use super::Build;
use plcc_syntax::network::ast::PinValue;

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
    pub(super) fn as_float(&self, value: PinValue, input: &Connection, float: Option<&Ty>) -> PinValue {
        match (value, float) {
            (PinValue::Operand(mut operand), Some(float)) if !input.in_out && !input.modifiers.negated => {
                let mut kind = self.kind(input);
                floats::of_bits(&mut operand, &mut kind, float);
                PinValue::Operand(operand)
            }
            (value, _) => value,
        }
    }
}
