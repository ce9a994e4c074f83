//! What a block states about itself.

use plcc_syntax::ast::{self, BlockName};
use plcc_syntax::chart::ast as chart;
use plcc_syntax::scl::ast::Dialect;

/// Attributes that state whether a block has optimised access: in sources, in SD documents.
const OPTIMIZED_ATTRIBUTES: [&str; 2] = ["S7_Optimized_Access", "S7_Optimized"];

/// The block has optimised access by its attributes.
pub fn is_optimized(header: &ast::Header) -> bool {
    header.attributes.iter().any(|(name, value)| {
        OPTIMIZED_ATTRIBUTES.iter().any(|known| known.eq_ignore_ascii_case(name))
            && value.trim().trim_matches(['\'', '"']).eq_ignore_ascii_case("TRUE")
    })
}

/// Whether a block is a list of statements without a header, which is OB 1 unless its file is named otherwise.
pub fn is_fragment(block: &ast::CodeBlock) -> bool {
    let span = block.name.span();
    matches!(block.name, BlockName::Numbered { .. })
        && span.start == span.end
        && matches!(block.code, ast::Code::Stl(_))
}

/// The form of SCL that a block has; none for other languages.
pub fn dialect(block: &ast::CodeBlock) -> Option<Dialect> {
    match &block.code {
        ast::Code::Scl(body) => Some(body.dialect),
        // Files that contain networks are those of the TIA Portal, and of later tools.
        ast::Code::Graphic(_) => Some(Dialect::Tia),
        ast::Code::Chart(body) => Some(match body.dialect {
            chart::Dialect::Classic => Dialect::Classic,
            chart::Dialect::Tia | chart::Dialect::Sfc => Dialect::Tia,
        }),
        ast::Code::Stl(_) => None,
    }
}
