#pragma once
/// Colours of values: viridis, which is perceptually uniform and readable without colour vision.

#include <array>

namespace weft::engine {

/// viridis (S. van der Walt, N. Smith, 2015, CC0) as polynomials of degree 6 (M. Zucker, 2018, CC0): sRGB
/// red, green and blue of a share t in [0, 1] are sums of row k times tᵏ, within 0.015 of the original.
inline constexpr std::array<std::array<double, 3>, 7> kColorMap = {{
    {0.2777273272, 0.0054073445, 0.3340998053},
    {0.1050930431, 1.4046135299, 1.3845901627},
    {-0.3308618288, 0.2148475595, 0.0950951630},
    {-4.6342304990, -5.7991009734, -19.3324409563},
    {6.2282699363, 14.1799333668, 56.6905526007},
    {4.7763849977, -13.7451453777, -65.3530326334},
    {-5.4354558559, 4.6458526122, 26.3124352496},
}};

/// sRGB red, green and blue in [0, 1] of a share, clamped to [0, 1].
std::array<double, 3> map_color(double share);

}  // namespace weft::engine
