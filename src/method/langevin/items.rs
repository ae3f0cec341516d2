//! What can be reproduced of this method: each item a study and its section of the report.

use crate::method::Item;

/// Every item, in the order of the page.
pub(super) const ITEMS: &[Item] = &[];
