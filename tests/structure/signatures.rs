//! The types that stand in what a crate promises: public signatures, fields and trait impls.

use syn::visit::{self, Visit};
use syn::{
    Field, Fields, ImplItem, ImplItemFn, Item, ItemConst, ItemEnum, ItemFn, ItemImpl, ItemStruct, ItemTrait,
    ItemType, PathSegment, Variant, Visibility,
};

/// Names of crates, and of their types, that a public signature must not have.
const FOREIGN: [&str; 18] = [
    "nalgebra",
    "SMatrix",
    "SVector",
    "toml",
    "serde_json",
    "serialport",
    "SerialPort",
    "tempfile",
    "NamedTempFile",
    "TempDir",
    "rustix",
    "plotters",
    "SVGBackend",
    "DrawingArea",
    "RGBColor",
    "crc32fast",
    "libm",
    "thiserror",
];

/// Collects the foreign names in what items promise.
#[derive(Default)]
pub(crate) struct Signatures {
    pub found: Vec<String>,
}

impl Signatures {
    /// Looks at the public parts of an item. Bodies of functions are no promise.
    pub(crate) fn look_at(&mut self, item: &Item) {
        match item {
            Item::Fn(ItemFn { vis: Visibility::Public(_), sig, .. }) => self.visit_signature(sig),
            Item::Const(ItemConst { vis: Visibility::Public(_), ty, .. }) => self.visit_type(ty),
            Item::Type(ItemType { vis: Visibility::Public(_), ty, .. }) => self.visit_type(ty),
            Item::Struct(ItemStruct { vis: Visibility::Public(_), fields, .. }) => {
                self.look_at_fields(fields, false);
            }
            Item::Enum(ItemEnum { vis: Visibility::Public(_), variants, .. }) => {
                for Variant { fields, .. } in variants {
                    self.look_at_fields(fields, true);
                }
            }
            Item::Trait(ItemTrait { vis: Visibility::Public(_), items, .. }) => {
                for item in items {
                    self.visit_trait_item(item);
                }
            }
            Item::Impl(ItemImpl { trait_, self_ty, items, .. }) => {
                if let Some((path, _)) = trait_ {
                    self.visit_path(path);
                    self.visit_type(self_ty);
                }
                for item in items {
                    if let ImplItem::Fn(ImplItemFn { vis: Visibility::Public(_), sig, .. }) = item {
                        self.visit_signature(sig);
                    }
                }
            }
            _ => {}
        }
    }

    fn look_at_fields(&mut self, fields: &Fields, of_variant: bool) {
        for Field { vis, ty, .. } in fields {
            if of_variant || matches!(vis, Visibility::Public(_)) {
                self.visit_type(ty);
            }
        }
    }
}

impl<'a> Visit<'a> for Signatures {
    fn visit_path_segment(&mut self, segment: &'a PathSegment) {
        if FOREIGN.iter().any(|foreign| segment.ident == foreign) {
            self.found.push(segment.ident.to_string());
        }
        visit::visit_path_segment(self, segment);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> usize {
        let mut signatures = Signatures::default();
        signatures.look_at(&syn::parse_str(text).unwrap());
        signatures.found.len()
    }

    #[test]
    fn a_foreign_type_is_seen_where_it_is_promised_and_only_there() {
        assert_eq!(found("impl From<toml::de::Error> for Wrong {}"), 1);
        assert_eq!(found("impl Line { pub fn state(&self) -> [SVector<f64, 2>; 3] { loop {} } }"), 1);
        assert_eq!(found("pub enum Wrong { Port(serialport::Error) }"), 1);
        assert_eq!(found("pub struct Plan { pub state: Option<SVector<f64, 2>> }"), 1);
        assert_eq!(found("pub struct Plan { state: SVector<f64, 2> }"), 0);
        assert_eq!(found("pub fn volume_ml() -> f64 { toml::from_str(TEXT) }"), 0);
        assert_eq!(found("pub(crate) fn state() -> SVector<f64, 2> { loop {} }"), 0);
    }
}
