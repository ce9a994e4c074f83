//! Accesses as text of SCL or STL: `#motor.speed[#i]`, `"tag"`, `%MW10`, `T#5s`.

use plcc_literal::distance::nearest;
use roxmltree::Node;

use super::data_type;
use crate::xml::{child, elements, is, text_of};

/// Which language the text is for: each writes addresses and status bits in its own way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notation {
    Scl,
    Stl,
}

/// The part of an access that plcc cannot read: the node, and a description.
pub struct Unreadable<'a, 'i> {
    pub node: Node<'a, 'i>,
    pub what: String,
    /// The word that a misspelt one resembles.
    pub meant: Option<&'static str>,
}

type Text<'a, 'i> = Result<String, Unreadable<'a, 'i>>;

/// The beginning of a scope has so many letters that it is meant: `LocalVar`.
const SCOPE_MIN: usize = 8;

/// How deep accesses may be nested, as indices.
const DEPTH_MAX: usize = 32;

/// Where an operand comes from. Source: LAD/FBD reference A2.2.
#[rustfmt::skip]
const SCOPES: [&str; 23] = [
    "LocalVariable", "GlobalVariable", "LocalConstant", "GlobalConstant", "LiteralConstant", "TypedConstant", "Address", "AddressConstant",
    "AlarmConstant", "Label", "Call", "CallWithType", "Instruction", "Statusword", "StatusWord", "Expression", "Unnamed", "Undef", "Reference",
    "PredefinedVariable", "UserType", "SystemType", "Indirect",
];

/// Text of an `Access`.
pub fn access<'a, 'i>(node: Node<'a, 'i>, notation: Notation) -> Text<'a, 'i> {
    access_at_depth(node, notation, 0)
}

fn access_at_depth<'a, 'i>(node: Node<'a, 'i>, notation: Notation, depth: usize) -> Text<'a, 'i> {
    if depth > DEPTH_MAX {
        return refuse(node, "indices that are nested too deeply");
    }
    let scope = node.attribute("Scope").unwrap_or_default();
    // What resembles none of them is read by its parts.
    let begins = || SCOPES.into_iter().find(|known| scope.len() >= SCOPE_MIN && known.starts_with(scope));
    if !SCOPES.contains(&scope)
        && let Some(meant) = nearest(scope, SCOPES.into_iter()).or_else(begins)
    {
        return Err(Unreadable { node, what: format!("an operand with the scope `{scope}`"), meant: Some(meant) });
    }
    let mut found: Option<String> = None;
    for part in elements(node).filter(|part| !is_informative(*part)) {
        let text = match part.tag_name().name() {
            "Symbol" => path(part, scope.starts_with("Local"), notation, depth)?,
            "Constant" => constant(part, scope)?,
            "Address" => address(part, notation)?,
            "Label" => part.attribute("Name").unwrap_or_default().to_string(),
            "Statusword" | "StatusWord" => status(part),
            "PredefinedVariable" => part.attribute("Name").unwrap_or_default().to_string(),
            // A type of the system has no quotes: `TypeOf(#v) = Int`.
            "DataType" if scope == "SystemType" && !text_of(part).starts_with('"') => text_of(part),
            "DataType" => quoted(text_of(part).trim_matches('"')),
            "Indirect" => indirect(part, notation, depth)?,
            // An index may be the value of a function.
            "Instruction" | "CallInfo" if depth > 0 && notation == Notation::Scl => {
                let name = part.attribute("Name").unwrap_or_default();
                let name = if is(part, "Instruction") { name.to_string() } else { quoted(name) };
                format!("{name}{}", words(part, depth)?)
            }
            "Expression" if depth > 0 && notation == Notation::Scl => words(part, depth)?,
            name if is_layout(name) => continue,
            other => return refuse(part, &format!("an operand with `{other}`")),
        };
        if found.is_some() {
            return refuse(part, "an operand of two parts");
        }
        found = Some(text);
    }
    match found {
        Some(text) if !text.is_empty() => Ok(text),
        _ => refuse(node, "an operand without a name"),
    }
}

/// SCL: the tokens and operands of a call or an expression in an index, `(ARR := #a, DIM := 1)`.
fn words<'a, 'i>(node: Node<'a, 'i>, depth: usize) -> Text<'a, 'i> {
    if depth > DEPTH_MAX {
        return refuse(node, "indices that are nested too deeply");
    }
    let mut text = String::new();
    for part in elements(node).filter(|part| !is_informative(*part)) {
        match part.tag_name().name() {
            "Token" => text.push_str(&format!(" {} ", part.attribute("Text").unwrap_or_default())),
            "Access" => text.push_str(&access_at_depth(part, Notation::Scl, depth + 1)?),
            "Parameter" => {
                text.push_str(&plain_or_quoted(part.attribute("Name").unwrap_or_default()));
                text.push_str(&words(part, depth + 1)?);
            }
            "NamelessParameter" | "Expression" => text.push_str(&words(part, depth + 1)?),
            "TemplateValue" | "AutomaticTyped" => {}
            name if is_layout(name) => {}
            other => return refuse(part, &format!("an index with `{other}`")),
        }
    }
    Ok(text)
}

/// Whether an element of that name is only formatting, a comment or a setting of the editor; the schema checks these.
fn is_layout(name: &str) -> bool {
    matches!(
        name,
        "Blank" | "NewLine" | "Comment" | "LineComment" | "BooleanAttribute" | "StringAttribute" | "IntegerAttribute"
    )
}

fn refuse<'a, 'i>(node: Node<'a, 'i>, what: &str) -> Text<'a, 'i> {
    Err(Unreadable { node, what: what.to_string(), meant: None })
}

/// `#a.b`, `"db".b`: the components below a `Symbol` or an `Instance`.
pub fn path<'a, 'i>(node: Node<'a, 'i>, local: bool, notation: Notation, depth: usize) -> Text<'a, 'i> {
    let mut text = String::new();
    let mut suffix = "";
    let mut components = 0;
    for part in elements(node).filter(|part| !is_informative(*part)) {
        match part.tag_name().name() {
            "Component" => {
                let name = part.attribute("Name").unwrap_or_default();
                match (components, local) {
                    (0, true) => text.push_str(&format!("#{}", plain_or_quoted(name))),
                    (0, false) => text.push_str(&quoted(name)),
                    (_, _) => text.push_str(&format!(".{}", plain_or_quoted(name))),
                }
                components += 1;
                text.push_str(&after_component(part, notation, depth)?);
                match part.attribute("SimpleAccessModifier").unwrap_or("None") {
                    "None" => {}
                    "Periphery" => suffix = ":P",
                    other => return refuse(part, &format!("the access `{other}` to `{name}`")),
                }
            }
            "Address" => match (part.attribute("Area").unwrap_or_default(), components) {
                (_, 0) => text.push_str(&address(part, notation)?),
                // `"db".%DBW4`
                ("DB" | "DI" | "None", 1) => text.push_str(&format!(".{}", address_in_block(part)?)),
                // The address of a tag, next to its name.
                ("Input" | "Output" | "Memory" | "PeripheryInput" | "PeripheryOutput" | "Timer" | "Counter", 1) => {}
                (area, _) => return refuse(part, &format!("an operand with an address in `{area}` after its name")),
            },
            "Token" => match part.attribute("Text").unwrap_or_default().trim() {
                "" | "." | "#" | "\"" => {}
                sign @ ("^" | "[" | "," | "]") => text.push_str(sign),
                ":P" => suffix = ":P",
                // `.%W1`, `.%DBW322`
                token if token.trim_start_matches('.').starts_with('%') => {
                    text.push_str(&format!(".{}", token.trim_start_matches('.').to_uppercase()));
                }
                token => return refuse(part, &format!("an operand with `{token}`")),
            },
            // An index after its component.
            "Access" if text.ends_with(['[', ',']) => text.push_str(&access_at_depth(part, notation, depth + 1)?),
            name if is_layout(name) => {}
            other => return refuse(part, &format!("an operand with `{other}`")),
        }
    }
    text.push_str(suffix);
    Ok(text)
}

/// What follows the name of a component: indices, `^`, a slice.
fn after_component<'a, 'i>(node: Node<'a, 'i>, notation: Notation, depth: usize) -> Text<'a, 'i> {
    let mut text = String::new();
    let modifier = node.attribute("AccessModifier").unwrap_or("None");
    match modifier {
        "None" | "Array" => {}
        "Reference" | "ReferenceToArray" => text.push('^'),
        other => return refuse(node, &format!("the access `{other}` to a component")),
    }
    let brackets = elements(node).any(|part| part.attribute("Text") == Some("["));
    let mut indices = 0;
    for part in elements(node).filter(|part| !is_informative(*part)) {
        match part.tag_name().name() {
            "Access" => {
                if !brackets {
                    text.push(if indices == 0 { '[' } else { ',' });
                }
                indices += 1;
                text.push_str(&access_at_depth(part, notation, depth + 1)?);
            }
            // SCL: an index may be an expression.
            "Token" => {
                let token = part.attribute("Text").unwrap_or_default();
                let word = token.chars().all(char::is_alphanumeric);
                text.push_str(&if word { format!(" {token} ") } else { token.to_string() });
            }
            name if is_layout(name) => {}
            other => return refuse(part, &format!("a component with `{other}`")),
        }
    }
    if indices > 0 && !brackets {
        text.push(']');
    }
    // The index may also come after the component.
    let after = node.next_sibling_element().and_then(|next| next.attribute("Text"));
    if modifier.ends_with("Array") && indices == 0 && after != Some("[") {
        return refuse(node, "an element of an array without an index");
    }
    if let Some(slice) = node.attribute("SliceAccessModifier").filter(|slice| *slice != "undef" && !slice.is_empty()) {
        text.push_str(&format!(".%{}", slice.to_uppercase()));
    }
    Ok(text)
}

/// A constant by its name, or its value as written.
fn constant<'a, 'i>(node: Node<'a, 'i>, scope: &str) -> Text<'a, 'i> {
    if let Some(name) = node.attribute("Name") {
        // A number of hardware, which the export gives next to its name. Fast counters and pulse generators are defined in plc.toml.
        let lower = name.to_ascii_lowercase();
        let is_own = ["local~hsc_", "local~pulse_"].iter().any(|prefix| lower.starts_with(prefix));
        if let Some(value) = child(node, "ConstantValue").map(text_of)
            && name.contains('~')
            && !is_own
            && !value.is_empty()
            && value.bytes().all(|digit| digit.is_ascii_digit())
        {
            return Ok(value);
        }
        return Ok(if scope.starts_with("Local") { format!("#{}", plain_or_quoted(name)) } else { quoted(name) });
    }
    let value = child(node, "ConstantValue").map(text_of).unwrap_or_default();
    let ty = child(node, "ConstantType").map(text_of).unwrap_or_default();
    if let Some(meant) = data_type::meant(&ty) {
        let (node, what) = (child(node, "ConstantType").unwrap_or(node), format!("a constant of the type `{ty}`"));
        return Err(Unreadable { node, what, meant: Some(meant) });
    }
    let is = |known: &str| ty.eq_ignore_ascii_case(known);
    let whole = || value.strip_prefix('-').unwrap_or(&value).bytes().all(|digit| digit.is_ascii_digit());
    Ok(match value.as_str() {
        "" if is("String") || is("WString") => "''".to_string(),
        "1" if is("Bool") => "TRUE".to_string(),
        "0" if is("Bool") => "FALSE".to_string(),
        // A REAL that is written like a whole number.
        _ if (is("Real") || is("LReal")) && !value.is_empty() && whole() => format!("{value}.0"),
        _ => value.replace(['\n', '\r'], " "),
    })
}

/// `BR`, `OV`, `>0`, `STW`.
fn status(node: Node) -> String {
    let name = node.attribute("Combination").or_else(|| node.attribute("Name")).unwrap_or_default();
    let known = match name {
        "EQ" | "Equal" => "==0",
        "NE" | "NotEqual" => "<>0",
        "GT" | "Greater" => ">0",
        "LT" | "Less" => "<0",
        "GE" | "GreaterOrEqual" => ">=0",
        "LE" | "LessOrEqual" => "<=0",
        other => other,
    };
    known.to_string()
}

/// The letter of a width, by the type of an address: none for a bit.
fn width_letter(ty: &str) -> Option<&'static str> {
    let is = |known: &[&str]| known.iter().any(|known| known.eq_ignore_ascii_case(ty));
    Some(match () {
        () if is(&["Bool"]) => "X",
        () if is(&["Byte", "SInt", "USInt", "Char"]) => "B",
        () if is(&["Word", "Int", "UInt", "S5Time", "Date", "WChar"]) => "W",
        () if is(&["DWord", "DInt", "UDInt", "Real", "Time", "Time_Of_Day", "TOD"]) => "D",
        () if is(&["LWord", "LInt", "ULInt", "LReal", "LTime", "LTime_Of_Day", "LTOD", "LDT"]) => "L",
        () if is(&["Date_And_LTime", "DTL", "Date_And_Time"]) => "L",
        () => return None,
    })
}

/// Whether an element is marked as informative.
fn is_informative(node: Node) -> bool {
    node.attribute("Informative").is_some_and(|value| value.eq_ignore_ascii_case("true") || value == "1")
}

/// Letters of an area, and whether it is accessed past the process image.
fn area_letters(area: &str, notation: Notation) -> Option<(&'static str, bool)> {
    Some(match (area, notation) {
        ("Input", _) => ("I", false),
        ("Output", _) => ("Q", false),
        ("Memory", _) => ("M", false),
        ("PeripheryInput", Notation::Scl) => ("I", true),
        ("PeripheryOutput", Notation::Scl) => ("Q", true),
        ("PeripheryInput", Notation::Stl) => ("PI", false),
        ("PeripheryOutput", Notation::Stl) => ("PQ", false),
        ("Local" | "LocalC" | "LocalN", _) => ("L", false),
        ("DB", _) => ("DB", false),
        ("DI", _) => ("DI", false),
        ("Timer", _) => ("T", false),
        ("Counter", _) => ("C", false),
        ("FB", _) => ("FB", false),
        ("FC", _) => ("FC", false),
        _ => return None,
    })
}

/// A number in an attribute.
fn number(node: Node, name: &str) -> Option<u32> {
    node.attribute(name).and_then(|value| value.trim().parse::<u32>().ok())
}

/// Letters, width and number of an address: `DBX0.0`, `MW4`. `letters` are those of its area.
fn place<'a, 'i>(node: Node<'a, 'i>, letters: &str) -> Text<'a, 'i> {
    let ty = node.attribute("Type").unwrap_or_default();
    let Some(width) = width_letter(ty) else { return refuse(node, &format!("an address of the type `{ty}`")) };
    let Some(offset) = number(node, "BitOffset") else { return refuse(node, "an address without `BitOffset`") };
    Ok(match width {
        "X" if letters.starts_with('D') => format!("{letters}X{}.{}", offset / 8, offset % 8),
        "X" => format!("{letters}{}.{}", offset / 8, offset % 8),
        _ if offset % 8 != 0 => return refuse(node, &format!("an address of the type `{ty}` in the middle of a byte")),
        width => format!("{letters}{width}{}", offset / 8),
    })
}

/// An address after the name of its data block: `%DBW4`.
fn address_in_block<'a, 'i>(node: Node<'a, 'i>) -> Text<'a, 'i> {
    Ok(format!("%{}", place(node, "DB")?))
}

/// `%I0.0`, `%DB1.DBW4`, `T5`.
fn address<'a, 'i>(node: Node<'a, 'i>, notation: Notation) -> Text<'a, 'i> {
    let area = node.attribute("Area").unwrap_or_default();
    let ty = node.attribute("Type").unwrap_or_default();
    let (block, offset) = (number(node, "BlockNumber"), number(node, "BitOffset"));
    let sign = if notation == Notation::Scl { "%" } else { "" };
    if area == "None" {
        return Ok(format!("{sign}{}", place(node, "DB")?));
    }
    let Some((letters, peripheral)) = area_letters(area, notation) else {
        return refuse(node, &format!("the area `{area}`"));
    };
    Ok(match letters {
        "T" | "C" => match block.filter(|block| *block > 0).or(offset) {
            Some(number) => format!("{sign}{letters}{number}"),
            None => return refuse(node, "a timer or counter without a number"),
        },
        "FB" | "FC" => match block {
            Some(number) => format!("{letters}{number}"),
            None => return refuse(node, "a block without a number"),
        },
        "DB" | "DI" => {
            let name = ty.trim().trim_matches('"');
            let is_block = ty.is_empty() || ty.starts_with("Block") || ty.eq_ignore_ascii_case("DB_ANY");
            let is_type = width_letter(ty).is_some();
            match block {
                // The data blocks of an export may have no numbers: the type names the right one.
                Some(_) if !is_block && !is_type && offset.unwrap_or(0) == 0 && !name.is_empty() => quoted(name),
                Some(block) if is_block || offset.is_none() => format!("{sign}{letters}{block}"),
                Some(block) if block > 0 && letters == "DB" => format!("{sign}DB{block}.{}", place(node, "DB")?),
                _ => format!("{sign}{}", place(node, letters)?),
            }
        }
        letters => {
            let suffix = if peripheral { ":P" } else { "" };
            format!("{sign}{}{suffix}", place(node, letters)?)
        }
    })
}

/// STL: `MW [AR1,P#2.0]`, `DBW [MD 4]`.
fn indirect<'a, 'i>(node: Node<'a, 'i>, notation: Notation, depth: usize) -> Text<'a, 'i> {
    if notation != Notation::Stl {
        return refuse(node, "an indirect address");
    }
    let width = match node.attribute("Width").unwrap_or_default() {
        "Bit" | "Bool" | "X" => "X",
        "Byte" | "B" => "B",
        "Word" | "W" => "W",
        "Double" | "DoubleWord" | "DWord" | "D" => "D",
        "None" | "" => "",
        other => return refuse(node, &format!("an indirect address of the width `{other}`")),
    };
    let letters = match node.attribute("Area").unwrap_or_default() {
        "" | "None" => "",
        area => match area_letters(area, notation) {
            Some((letters, _)) => letters,
            None => return refuse(node, &format!("the area `{area}`")),
        },
    };
    let width = if width == "X" && !letters.is_empty() && !letters.starts_with('D') { "" } else { width };
    let register = node.attribute("Register").filter(|register| !register.is_empty() && *register != "None");
    let offset = number(node, "BitOffset").unwrap_or(0);
    match (register, child(node, "Access")) {
        (Some(register), _) => Ok(format!("{letters}{width} [{register},P#{}.{}]", offset / 8, offset % 8)),
        (None, Some(pointer)) => Ok(format!("{letters}{width} [{}]", access_at_depth(pointer, notation, depth + 1)?)),
        (None, None) => refuse(node, "an indirect address without its pointer"),
    }
}

/// The name in quotes; characters that a name cannot contain are left out.
pub fn quoted(name: &str) -> String {
    let name: String = name.chars().filter(|c| *c != '"').map(|c| if c.is_control() { ' ' } else { c }).collect();
    format!("\"{name}\"")
}

/// The name as a word of SCL and STL, otherwise in quotes.
pub fn plain_or_quoted(name: &str) -> String {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    let plain = name.starts_with(letter) && name.chars().all(|c| letter(c) || c.is_ascii_digit());
    if plain { name.to_string() } else { quoted(name) }
}

/// The best position for the text of an access: over the name of its first component.
pub fn wanted_place(node: Node) -> usize {
    let named =
        |part: &Node| part.attribute_node("Name").map(|name| (name.range_value().start, name.value().to_string()));
    let found = node.descendants().find(|part| is(*part, "Component") || is(*part, "Constant"));
    let Some((start, name)) = found.as_ref().and_then(named) else {
        let value = node.descendants().find(|part| is(*part, "ConstantValue"));
        return value.and_then(|value| value.first_child()).map_or(node.range().start, |text| text.range().start);
    };
    // `#` and a quote, or one of them.
    let is_local = node.attribute("Scope").is_some_and(|scope| scope.starts_with("Local"));
    start.saturating_sub(if is_local && plain_or_quoted(&name).starts_with('"') { 2 } else { 1 })
}
