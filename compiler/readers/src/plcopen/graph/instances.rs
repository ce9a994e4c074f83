//! Instances: the block that is drawn is that of the variable.

use super::super::functions;
use super::super::objects::Object;
use super::super::types::Ty;
use super::Build;
use plcc_diag::{Code, Diagnostic};

/// The function blocks that every editor has. Source: IEC 61131-3, standard function blocks.
const STANDARD: [&str; 10] = ["sr", "rs", "r_trig", "f_trig", "ctu", "ctd", "ctud", "tp", "ton", "tof"];

impl Build<'_, '_, '_> {
    /// Reports a block whose instance is declared with another type, although only the name of the instance is needed to call it.
    pub(super) fn check_instance(&mut self, object: &Object) {
        let Some(range) = object.instance.clone() else { return };
        let Some(Ty::Named(declared)) = self.type_of(range.clone()) else { return };
        // The editor writes the name of a library before a point, or not.
        let last = |name: &str| name.rsplit('.').next().unwrap_or(name).to_lowercase();
        // `CTU` and `CTU_INT` are one block.
        let library = |name: &str| functions::block(self.reader.editor, name);
        let is_same = library(&object.name).is_some_and(|block| library(&declared) == Some(block));
        if is_same || last(&object.name) == last(&declared) {
            return;
        }
        // The data of library blocks may have another name, but not that of another block.
        let is_standard = |name: &str| STANDARD.contains(&last(name).as_str());
        let are_standard = is_standard(&object.name) && is_standard(&declared);
        if !are_standard && plcc_stdlib::blocks().iter().any(|block| block.name.eq_ignore_ascii_case(&object.name)) {
            return;
        }
        let instance = self.reader.overlay.get(range).unwrap_or_default().trim();
        let title = format!("`{instance}` is not an instance of `{}`", object.name);
        let help = format!("write the type that `{instance}` is declared with, or name another instance");
        let message = Diagnostic::new(Code::NoBlockFits, object.span, title);
        self.reader.messages.push(message.label("the variable is declared with another type").help(help));
    }
}
