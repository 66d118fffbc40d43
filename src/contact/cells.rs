//! Grains sorted into cells, to find those that are near.

use crate::Vec3;
use crate::heap;

/// Grains sorted into cubic cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cells {
    low: Vec3,
    size: f64,
    count: [usize; 3],
    start: Vec<u32>,
    grains: Vec<u32>,
    cell_of: Vec<u32>,
}

impl Cells {
    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.start) + heap::bytes(&self.grains) + heap::bytes(&self.cell_of)
    }

    /// Sorts `position` into cells no smaller than `reach` \[m\].
    pub(crate) fn sort(&mut self, position: &[Vec3], reach: f64) {
        let (mut low, mut high) = (Vec3::repeat(f64::MAX), Vec3::repeat(f64::MIN));
        for at in position {
            low = low.inf(at);
            high = high.sup(at);
        }
        // Far-flung grains must not ask for more cells than there are grains to fill them.
        let extent = (high - low).max().max(reach);
        let most = (position.len() as f64).cbrt().ceil().mul_add(4.0, 1.0);
        self.size = reach.max(extent / most);
        self.low = low;
        self.count =
            std::array::from_fn(|axis| ((high[axis] - low[axis]) / self.size) as usize + 1);
        let cells = self.count.iter().product::<usize>();
        self.start.clear();
        self.start.resize(cells + 1, 0);
        self.cell_of.clear();
        for at in position {
            let cell = self.cell(at);
            let index = self.index(cell);
            self.cell_of.push(index as u32);
            self.start[index + 1] += 1;
        }
        for cell in 0..cells {
            self.start[cell + 1] += self.start[cell];
        }
        self.grains.clear();
        self.grains.resize(position.len(), 0);
        // Filling backwards with a decreasing end leaves `start` as it must be.
        for (grain, &cell) in self.cell_of.iter().enumerate().rev() {
            let end = &mut self.start[cell as usize + 1];
            *end -= 1;
            self.grains[*end as usize] = grain as u32;
        }
        self.start.remove(0);
        self.start.push(position.len() as u32);
    }

    fn cell(&self, at: &Vec3) -> [usize; 3] {
        std::array::from_fn(|axis| {
            (((at[axis] - self.low[axis]) / self.size) as usize).min(self.count[axis] - 1)
        })
    }

    fn index(&self, cell: [usize; 3]) -> usize {
        (cell[2] * self.count[1] + cell[1]) * self.count[0] + cell[0]
    }

    /// Calls `visit` with every grain in the cells around `at`, in a fixed order.
    pub(crate) fn for_each_near(&self, at: &Vec3, mut visit: impl FnMut(u32)) {
        let cell = self.cell(at);
        let span =
            |axis: usize| cell[axis].saturating_sub(1)..(cell[axis] + 2).min(self.count[axis]);
        for z in span(2) {
            for y in span(1) {
                let x = span(0);
                let first = self.start[self.index([x.start, y, z])] as usize;
                let last = self.start[self.index([x.end - 1, y, z]) + 1] as usize;
                for &grain in &self.grains[first..last] {
                    visit(grain);
                }
            }
        }
    }
}
