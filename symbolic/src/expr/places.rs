//! Where the nodes of a part of the arena stand among themselves.

use super::Id;

/// Some nodes in the order of the arena, and the place of each in that list.
pub struct Places {
    list: Vec<Id>,
    first: usize,
    /// Places by distance from the first node, where the nodes lie close together; else the list is searched.
    table: Vec<u32>,
}

impl Places {
    /// Of a list that is sorted.
    pub fn new(list: Vec<Id>) -> Places {
        let first = list.first().map_or(0, |id| id.index());
        let span = list.last().map_or(0, |id| id.index() + 1 - first);
        let mut table = Vec::new();
        if span <= 16 * list.len() {
            table = vec![u32::MAX; span];
            for (place, id) in list.iter().enumerate() {
                table[id.index() - first] = place as u32;
            }
        }
        Places { list, first, table }
    }

    /// The nodes.
    pub fn list(&self) -> &[Id] {
        &self.list
    }

    /// The place of one of them.
    pub fn of(&self, id: Id) -> usize {
        self.find(id).unwrap_or(usize::MAX)
    }

    /// The place of a node; `None` for one that is not in the list.
    pub fn find(&self, id: Id) -> Option<usize> {
        if self.table.is_empty() {
            return self.list.binary_search(&id).ok();
        }
        let place = self.table.get(id.index().checked_sub(self.first)?)?;
        (*place != u32::MAX).then_some(*place as usize)
    }
}
