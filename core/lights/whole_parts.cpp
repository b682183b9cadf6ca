#include "lights/whole_parts.h"

namespace rayleaf {

Float4 in_whole_parts(Float4 weights, double parts) {
    const float most = largest_of(weights), sum = sum_of(weights);
    if (!(most < sum) || !std::isfinite(sum)) return weights;
    const float per_part = sum / static_cast<float>(parts), part = 1.0f / per_part;
    Float4 result = weights;
    int largest = 0;
    float others = 0.0f;
    for (int i = 0; i < 4; ++i) {
        if (weights[i] > weights[largest]) largest = i;
        const float count = weights[i] * part;
        if (count >= 0.5f) result[i] = std::floor(count + 0.5f) * per_part;
    }
    for (int i = 0; i < 4; ++i)
        if (i != largest) others += result[i];
    result[largest] = sum - others;
    return result[largest] > 0.5f * most ? result : weights;
}

}  // namespace rayleaf
