//! All drawings of a book in one picture.

use std::collections::HashMap;

use super::{Body, Book};
use crate::scene::{Anchor, Ink, Scene};
use crate::svg::{self, Shown};
use crate::{logic, metrics};

impl Book {
    /// All drawings below each other, each with the name of its block and its network. `values`: the state that is shown.
    pub fn poster(&self, values: Option<&HashMap<String, String>>) -> String {
        let mut all = Scene { width: 0, height: 6, items: Vec::new() };
        let mut shown = Shown::default();
        let mut nets = 0;
        for page in &self.pages {
            for section in &page.sections {
                let (Body::Drawing { sheet, .. }, Some(mut scene)) = (&section.content, section.picture()) else {
                    continue;
                };
                let network = if section.number > 0 { format!(", network {}", section.number) } else { String::new() };
                let title = if section.title.is_empty() { String::new() } else { format!(": {}", section.title) };
                let caption = format!("{}{network}{title}", page.id);
                all.text((10, all.height + 12), Anchor::Start, Ink::Note, &caption, "");
                all.width = all.width.max(scene.width).max(20 + metrics::width(&caption, Ink::Note.height()));
                scene.renumber(nets);
                if let Some(values) = values {
                    let known = logic::logic(sheet).values(&|key| values.get(key).cloned());
                    shown.nets.extend(known.into_iter().map(|(net, value)| (net + nets, value)));
                }
                nets += sheet.nets.len() + 1;
                let (top, height) = (all.height + 14, scene.height);
                all.add(scene, (0, top));
                all.height = top + height + 6;
            }
        }
        let active = values.iter().flat_map(|values| values.iter()).filter(|(_, value)| *value == "1");
        shown.active = active.map(|(key, _)| key.clone()).collect();
        svg::file(&all, values.map(|_| &shown))
    }
}
