#include "ri_tree/cell_leaf.h"

namespace rayleaf {
int leaf_value_count(OutputKind kind) {
    switch (kind) {
        case OutputKind::Simple:
            return 5;
        case OutputKind::Mirror:
            return 3;
        case OutputKind::Glass:
            return 8;
        case OutputKind::Volume:
            return 1;
    }
    return 0;
}

}  // namespace rayleaf
