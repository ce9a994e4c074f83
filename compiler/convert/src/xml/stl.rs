//! Statements of STL: `StatementList`.

use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    AddressRegister, Area, BlockName, Bound, Call, CellKind, CodeBlock, Operand, OperandKind, Parameter, Path,
    PathPart, PathRoot, SpecialRegister, Statement, StatementKind, StatusOperand, Width,
};
use plcc_syntax::scl::ast::NameForm;
use plcc_syntax::stl::{Mnemonics, StlInsn};

use super::access::{Whose, address, area_name, whose};
use super::{Library, Uids, comment_text, referred};
use crate::node::Node;
use crate::operand;
use crate::trivia::Remark;
use crate::writer::{Notation, Writer};

/// Mnemonics with other letters in the file.
const WORDS: &[(&str, &str)] = &[
    ("=", "Assign"),
    ("FP", "Rise"),
    ("FN", "Fall"),
    ("A(", "A_BRACK"),
    ("AN(", "AN_BRACK"),
    ("O(", "O_BRACK"),
    ("ON(", "ON_BRACK"),
    ("X(", "X_BRACK"),
    ("XN(", "XN_BRACK"),
    (")", "BRACKET"),
    ("+", "ADD"),
    ("+I", "ADD_I"),
    ("-I", "SUB_I"),
    ("*I", "MUL_I"),
    ("/I", "DIV_I"),
    ("+D", "ADD_D"),
    ("-D", "SUB_D"),
    ("*D", "MUL_D"),
    ("/D", "DIV_D"),
    ("+R", "ADD_R"),
    ("-R", "SUB_R"),
    ("*R", "MUL_R"),
    ("/R", "DIV_R"),
    ("==I", "EQ_I"),
    ("<>I", "NE_I"),
    (">I", "GT_I"),
    ("<I", "LT_I"),
    (">=I", "GE_I"),
    ("<=I", "LE_I"),
    ("==D", "EQ_D"),
    ("<>D", "NE_D"),
    (">D", "GT_D"),
    ("<D", "LT_D"),
    (">=D", "GE_D"),
    ("<=D", "LE_D"),
    ("==R", "EQ_R"),
    ("<>R", "NE_R"),
    (">R", "GT_R"),
    ("<R", "LT_R"),
    (">=R", "GE_R"),
    ("<=R", "LE_R"),
    ("RND+", "RND_PLUS"),
    ("RND-", "RND_MINUS"),
    ("+AR1", "ADD_AR1"),
    ("+AR2", "ADD_AR2"),
    ("MCR(", "MCR_BRACK"),
    (")MCR", "BRACK_MCR"),
];

const NAMESPACE: &str = "http://www.siemens.com/automation/Openness/SW/NetworkSource/StatementList/v4";

/// The statements of a network. `end`: comments after the last statement and before this byte follow it.
pub fn statements(
    list: &[Statement],
    block: &CodeBlock,
    library: &Library,
    end: Option<u32>,
    writer: &mut Writer,
) -> Node {
    let before = (writer.notation, writer.mnemonics, writer.source);
    (writer.notation, writer.mnemonics) = (Notation::Stl, Mnemonics::En);
    // A number keeps its digits: a LREAL has more of them than its constant.
    writer.source = Some(writer.trivia.source()).filter(|source| !source.is_empty()).or(writer.source);
    let mut maker = Maker { block, library, uids: Uids::new(), writer };
    let mut node = Node::new("StatementList").with("xmlns", NAMESPACE);
    for statement in list {
        maker.statement(statement, &mut node);
    }
    if let Some(end) = end {
        maker.remarks(end, &mut node);
    }
    (writer.notation, writer.mnemonics, writer.source) = before;
    node
}

/// A network of comments.
pub fn remarks(list: &[Remark], block: &CodeBlock, library: &Library, writer: &mut Writer) -> Node {
    let mut node = Node::new("StatementList").with("xmlns", NAMESPACE);
    Maker { block, library, uids: Uids::new(), writer }.rows(list, &mut node);
    node
}

struct Maker<'a, 'w, 't> {
    block: &'a CodeBlock,
    library: &'a Library,
    uids: Uids,
    writer: &'w mut Writer<'t>,
}

impl Maker<'_, '_, '_> {
    /// The comments before byte `at`, as rows of their own.
    fn remarks(&mut self, at: u32, list: &mut Node) {
        let mut remarks = self.writer.trivia.before(at);
        // Those of the block and the network are with them.
        remarks.retain(|remark| !self.writer.is_written(&remark.text));
        self.rows(&remarks, list);
    }

    fn rows(&mut self, remarks: &[Remark], list: &mut Node) {
        for line in remarks.iter().flat_map(|remark| remark.text.lines()) {
            let mut row = self.numbered("StlStatement");
            row.push(self.comment(line));
            row.push(self.numbered("StlToken").with("Text", "COMMENT"));
            list.push(row);
        }
    }

    fn statement(&mut self, statement: &Statement, list: &mut Node) {
        self.remarks(statement.span.start, list);
        let mut row = self.numbered("StlStatement");
        if let Some(label) = &statement.label {
            let label = Node::new("Label").with("Name", &label.name);
            let declaration = self.numbered("LabelDeclaration").child(label);
            row.push(declaration.child(Node::new("Token").with("Text", ":")));
        }
        match &statement.kind {
            StatementKind::Empty => row.push(self.numbered("StlToken").with("Text", "EMPTY_LINE")),
            StatementKind::Instruction { insn, operand, .. } => self.instruction(*insn, operand.as_ref(), &mut row),
            StatementKind::Call(call) => self.call(call, &mut row),
            StatementKind::Pragma(_) => {}
            StatementKind::Error => {
                let help = "repair the source first";
                self.writer.refuse(statement.span, "a statement that was not understood", help);
            }
        }
        let remarks: Vec<Remark> = self.writer.trivia.on_line(statement.span.end);
        for remark in remarks {
            row.push(self.comment(&remark.text));
        }
        list.push(row);
    }

    fn numbered(&mut self, name: &'static str) -> Node {
        Node::new(name).with("UId", self.uids.next())
    }

    fn comment(&mut self, text: &str) -> Node {
        let text = Node::of("Text", comment_text(text)).with("UId", self.uids.next());
        self.numbered("LineComment").child(text)
    }

    fn instruction(&mut self, insn: StlInsn, operand: Option<&Operand>, row: &mut Node) {
        let mnemonic = insn.mnemonic(Mnemonics::En);
        let word = WORDS.iter().find(|(known, _)| *known == mnemonic).map_or(mnemonic, |(_, word)| word);
        let token = |maker: &mut Self, word: &str| maker.numbered("StlToken").with("Text", word);
        // Words that include their operand.
        let whole = match (insn, operand.map(|operand| &operand.kind)) {
            (_, None) => Some(word.to_string()),
            (StlInsn::Load, Some(OperandKind::Special(SpecialRegister::Stw))) => Some("L_STW".to_string()),
            (StlInsn::Transfer, Some(OperandKind::Special(SpecialRegister::Stw))) => Some("T_STW".to_string()),
            (_, Some(OperandKind::Register(register))) => {
                let register = match register {
                    AddressRegister::Ar1 => "AR1",
                    AddressRegister::Ar2 => "AR2",
                };
                Some(format!("{word}_{register}"))
            }
            (StlInsn::Nop, Some(OperandKind::Literal(value))) => {
                Some(format!("NOP_{}", crate::literal::stl(value, Mnemonics::En)))
            }
            _ => None,
        };
        if let Some(whole) = whole {
            return row.push(token(self, &whole));
        }
        let Some(operand) = operand else { return };
        let is_open = insn == StlInsn::OpenDb;
        row.push(token(self, if is_open { "OPEN_DB" } else { word }));
        row.push(Node::new("Blank"));
        if let Some(access) = self.access(operand) {
            row.push(access);
        }
    }

    fn call(&mut self, call: &Call, row: &mut Node) {
        row.push(self.numbered("StlToken").with("Text", "CALL"));
        row.push(Node::new("Blank"));
        let uid = self.uids.next();
        let (name, instance) = match (&call.target.kind, &call.instance) {
            (OperandKind::Block(name), instance) => {
                (Some(referred(name, self.library, self.writer)), instance.as_ref())
            }
            (OperandKind::Path(Path { root: PathRoot::Quoted { name, .. }, parts, .. }), instance)
                if parts.is_empty() =>
            {
                (Some(name.clone()), instance.as_ref())
            }
            (OperandKind::Path(path), instance) => match (self.declared(path), &path.root) {
                // A multi-instance, by the type of its declaration.
                (Some(of), _) if instance.is_none() => (Some(of), Some(&call.target)),
                // An instruction, by its name alone.
                (None, PathRoot::Bare { name, .. }) if path.parts.is_empty() => (Some(name.clone()), instance.as_ref()),
                _ => (None, None),
            },
            _ => (None, None),
        };
        let Some(name) = name else {
            let help = "call a block, or an instance that the block declares";
            return self.writer.refuse(call.target.span, "SimaticML has no form for this call", help);
        };
        let is_fb = instance.is_some();
        let is_own = self.library.blocks.contains_key(&name.to_lowercase());
        let types = if is_own { Vec::new() } else { self.types(call) };
        // `CALL TON, #wait`, `CALL "TON", #wait`: data of the type IEC_TIMER does not say which instruction has it.
        let is_bare = matches!(&call.target.kind, OperandKind::Path(Path { root: PathRoot::Bare { .. }, .. }));
        let is_local = |own: &Operand| {
            matches!(&own.kind, OperandKind::Path(Path { root: PathRoot::Local { .. } | PathRoot::Bare { .. }, .. }))
        };
        let has_shared_data = !is_own && SHARED_DATA.iter().any(|known| known.eq_ignore_ascii_case(&name));
        let is_instruction = match &call.instance {
            Some(own) => is_bare || !types.is_empty() || (has_shared_data && is_local(own)),
            // The type of a multi-instance is that of its declaration.
            None => instance.is_none() && !types.is_empty(),
        };
        let mut info = if is_instruction {
            self.numbered("Instruction").with("Name", &name)
        } else {
            self.numbered("CallInfo").with("Name", &name).with("BlockType", if is_fb { "FB" } else { "FC" })
        };
        if let Some(instance) = instance {
            let path = match &instance.kind {
                OperandKind::Path(path) => self.path(path, "Instance"),
                OperandKind::Block(name) => {
                    let name = referred(name, self.library, self.writer);
                    Some((false, self.numbered("Instance").child(component(&name))))
                }
                _ => None,
            };
            let Some((local, mut node)) = path else {
                let help = "name a data block or a variable of the block";
                return self.writer.refuse(instance.span, "SimaticML has no form for this instance", help);
            };
            let scope = if local { "LocalVariable" } else { "GlobalVariable" };
            node.attributes.push(("Scope", scope.to_string()));
            info.push(node);
        }
        if is_instruction {
            info.children.extend(types);
        }
        for parameter in &call.parameters {
            if is_instruction && self.named_type(parameter).is_some() {
                continue;
            }
            let mut node = self.numbered("Parameter").with("Name", &parameter.name);
            let known = self.library.blocks.get(&name.to_lowercase());
            let section = known.and_then(|(_, sections, _)| {
                let has = |section: &&plcc_syntax::ast::Section| {
                    section.variables.iter().any(|variable| variable.name.eq_ignore_ascii_case(&parameter.name))
                };
                sections.iter().find(has).map(|section| section.kind)
            });
            let section = match section {
                Some(plcc_syntax::ast::SectionKind::Output) => "Output",
                Some(plcc_syntax::ast::SectionKind::InOut) => "InOut",
                _ if parameter.name.eq_ignore_ascii_case("RET_VAL") => "Return",
                _ => "Input",
            };
            node.attributes.push(("Section", section.to_string()));
            if let Some(actual) = &parameter.actual
                && let Some(access) = self.access(actual)
            {
                node.push(access);
            }
            info.push(node);
        }
        row.push(Node::new("Access").with("Scope", "Call").with("UId", uid).child(info));
    }

    /// The types and the relation that a call of an instruction names, in braces or as its first parameters.
    fn types(&self, call: &Call) -> Vec<Node> {
        let in_braces = call.types.iter().map(|named| {
            let is_of_program = self.library.types.contains(&named.ty.to_lowercase());
            (named.name.clone(), if is_of_program { format!("\"{}\"", named.ty) } else { named.ty.clone() })
        });
        let in_list = call.parameters.iter().filter_map(|one| Some((one.name.clone(), self.named_type(one)?)));
        let node = |(name, ty): (String, String)| {
            let kind = if is_relation(&name) { "Operation" } else { "Type" };
            Node::of("TemplateValue", ty).with("Name", name).with("Type", kind)
        };
        in_braces.chain(in_list).map(node).collect()
    }

    /// The type that `value_type := Int` among the parameters of an instruction names.
    fn named_type(&self, parameter: &Parameter) -> Option<String> {
        let OperandKind::Path(path) = &parameter.actual.as_ref()?.kind else { return None };
        let of_type = parameter.name.to_ascii_lowercase().ends_with("type");
        match &path.root {
            _ if !path.parts.is_empty() => None,
            PathRoot::Bare { name, .. } => {
                (of_type && is_type(name) || is_relation(&parameter.name)).then(|| name.clone())
            }
            PathRoot::Quoted { name, .. } => {
                (of_type && self.library.types.contains(&name.to_lowercase())).then(|| format!("\"{name}\""))
            }
            PathRoot::Local { .. } | PathRoot::Block(_) => None,
        }
    }

    /// The name of the type of an instance that the block or a data block declares, also as a component or an element.
    fn declared(&self, path: &Path) -> Option<String> {
        let root = match &path.root {
            PathRoot::Local { name, .. } | PathRoot::Bare { name, .. } => {
                let mut variables = self.block.sections.iter().flat_map(|section| &section.variables);
                &variables.find(|variable| variable.name.eq_ignore_ascii_case(name))?.ty
            }
            PathRoot::Quoted { name, .. } => self.library.content(name)?,
            PathRoot::Block(name) => self.library.content(&self.library.own_name(name))?,
        };
        match &self.library.part(root, &path.parts)?.kind {
            plcc_syntax::ast::TypeKind::Block(name) => Some(self.library.block_name(name)),
            plcc_syntax::ast::TypeKind::Named(name) => Some(name.clone()),
            _ => None,
        }
    }

    // Operands.

    fn access(&mut self, operand: &Operand) -> Option<Node> {
        let uid = self.uids.next();
        let node = |scope: &str| Node::new("Access").with("Scope", scope).with("UId", uid);
        let found = match &operand.kind {
            OperandKind::Path(path) => self
                .path(path, "Symbol")
                .map(|(local, symbol)| node(if local { "LocalVariable" } else { "GlobalVariable" }).child(symbol)),
            OperandKind::Peripheral(path) => self.path(path, "Symbol").map(|(local, mut symbol)| {
                if let Some(last) = symbol.children.last_mut() {
                    last.attributes.push(("SimpleAccessModifier", "Periphery".to_string()));
                }
                node(if local { "LocalVariable" } else { "GlobalVariable" }).child(symbol)
            }),
            OperandKind::Block(BlockName::Symbol { name, .. }) => {
                Some(node("GlobalVariable").child(Node::new("Symbol").child(component(name))))
            }
            OperandKind::Special(register) => {
                let variable = Node::new("PredefinedVariable").with("Name", register.name());
                Some(node("PredefinedVariable").child(variable))
            }
            OperandKind::Label(name) => Some(node("Label").child(Node::new("Label").with("Name", name))),
            OperandKind::Status(status) => {
                Some(node("Statusword").child(Node::new("Statusword").with("Combination", status_name(*status))))
            }
            OperandKind::Literal(_) | OperandKind::AddressOf(_) => {
                let text = operand::operand(operand, self.writer);
                Some(node("LiteralConstant").child(Node::new("Constant").child(Node::of("ConstantValue", text))))
            }
            OperandKind::DbAbsolute { db: BlockName::Symbol { name, .. }, width, byte, bit } => {
                let numbered = OperandKind::Absolute { area: Area::Db, width: *width, byte: *byte, bit: *bit };
                let mut place = address(&numbered)?;
                place.attributes.retain(|(key, _)| *key != "Area");
                let symbol = Node::new("Symbol").child(component(name)).child(place.with("Area", "None"));
                Some(node("GlobalVariable").child(symbol))
            }
            OperandKind::MemoryIndirect { area, width, pointer } => {
                let pointer = self.access(pointer)?;
                let indirect = Node::new("Indirect").with("Width", width_name(*width)).with("Area", area_name(*area));
                Some(node("Indirect").child(indirect.child(pointer)))
            }
            OperandKind::CellIndirect { kind, pointer } => {
                let pointer = self.access(pointer)?;
                let area = match kind {
                    CellKind::Timer => "Timer",
                    CellKind::Counter => "Counter",
                };
                let indirect = Node::new("Indirect").with("Width", "None").with("Area", area);
                Some(node("Indirect").child(indirect.child(pointer)))
            }
            OperandKind::RegisterIndirect { area, width, register, offset } => {
                let register = match register {
                    AddressRegister::Ar1 => "AR1",
                    AddressRegister::Ar2 => "AR2",
                };
                // The pointer says whether it is a bit.
                let width = if area.is_none() && *width == Width::Bit { "None" } else { width_name(*width) };
                let indirect = Node::new("Indirect")
                    .with("Width", width)
                    .with("Area", area.map_or("None", area_name))
                    .with("Register", register)
                    .with("BitOffset", offset);
                Some(node("Indirect").child(indirect))
            }
            // Only a symbol can have `:P`.
            OperandKind::Absolute { area: Area::Pi | Area::Pq, width: Width::Bit, .. } => None,
            kind => address(kind).map(|address| node("Address").child(address)),
        };
        if found.is_none() {
            let help = "leave the block in its language, or write the statement with another operand";
            self.writer.refuse(operand.span, "SimaticML has no form for this operand", help);
        }
        found
    }

    /// Components of a path, and whether it begins with a variable of the block.
    fn path(&mut self, path: &Path, element: &'static str) -> Option<(bool, Node)> {
        let (local, name) = match &path.root {
            PathRoot::Local { name, .. } => (true, name.clone()),
            PathRoot::Quoted { name, .. } => (false, name.clone()),
            PathRoot::Bare { name, .. } => {
                let is_local = whose(name, NameForm::Bare, self.block) != Whose::Global;
                (is_local, name.clone())
            }
            PathRoot::Block(name) => (false, referred(name, self.library, self.writer)),
        };
        let mut node = Node::new(element);
        node.push(component(&name));
        for part in &path.parts {
            match part {
                PathPart::Member { name, .. } => node.push(component(name)),
                PathPart::Index { values, .. } => {
                    let mut list = Vec::new();
                    for value in values {
                        let access = self.numbered("Access");
                        list.push(match value {
                            Bound::Number(number, _) => {
                                let value = Node::new("Constant").child(Node::of("ConstantValue", number.to_string()));
                                access.with("Scope", "LiteralConstant").child(value)
                            }
                            Bound::Path(path) => {
                                let (local, symbol) = self.path(path, "Symbol")?;
                                let scope = if local { "LocalVariable" } else { "GlobalVariable" };
                                access.with("Scope", scope).child(symbol)
                            }
                            Bound::Name(..) | Bound::Expr(_) => return None,
                        });
                    }
                    let last = node.children.last_mut()?;
                    last.attributes.push(("AccessModifier", "Array".to_string()));
                    last.children.extend(list);
                }
            }
        }
        Some((local, node))
    }
}

/// A word that is the name of a type.
fn is_type(word: &str) -> bool {
    let upper = word.to_ascii_uppercase();
    let others = ["STRING", "WSTRING", "DT", "DATE_AND_TIME", "DTL", "VARIANT"];
    Elementary::from_word(&upper).is_some() || others.contains(&upper.as_str())
}

/// Instructions whose instances may be of the type IEC_TIMER or IEC_COUNTER.
const SHARED_DATA: [&str; 7] = ["TP", "TON", "TOF", "TONR", "CTU", "CTD", "CTUD"];

/// The relation of T_COMP or S_COMP: `relation := EQ`.
fn is_relation(name: &str) -> bool {
    name.eq_ignore_ascii_case("relation")
}

fn component(name: &str) -> Node {
    Node::new("Component").with("Name", name)
}

fn width_name(width: Width) -> &'static str {
    match width {
        Width::Bit => "Bit",
        Width::Byte => "Byte",
        Width::Word => "Word",
        Width::Dword | Width::Lword => "Double",
    }
}

fn status_name(status: StatusOperand) -> &'static str {
    match status {
        StatusOperand::Br => "BR",
        StatusOperand::Ov => "OV",
        StatusOperand::Os => "OS",
        StatusOperand::Uo => "UO",
        StatusOperand::Eq0 => "EQ",
        StatusOperand::Ne0 => "NE",
        StatusOperand::Gt0 => "GT",
        StatusOperand::Lt0 => "LT",
        StatusOperand::Ge0 => "GE",
        StatusOperand::Le0 => "LE",
    }
}
