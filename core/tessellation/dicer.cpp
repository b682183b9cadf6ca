#include "tessellation/dicer.h"

#include "tessellation/dice.h"

namespace rayleaf {

void LevelDicer::dice(uint32_t subpatch, Grid& grid) const {
    GridRows rows;
    dice_rows(subpatch, rows);
    pack(rows, grid);
}

void LevelDicer::dice_part(uint32_t subpatch, const GridPart& part, Grid& grid) const {
    GridRows rows;
    dice_part_rows(subpatch, part, rows.target());
    pack(rows, grid);
}

}  // namespace rayleaf
