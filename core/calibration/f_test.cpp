#include "core/calibration/f_test.h"

#include <algorithm>

#include "core/acceptance/distributions.h"

namespace seamwright {

double freed_chance(double squares, double least, double freed, double freedom) {
    if (!(freedom > 0) || !(freed > 0)) return 1;
    if (!(least > 0)) return squares > 0 ? 0 : 1;
    return f_upper(freed, freedom, std::max(0.0, squares - least) / freed / (least / freedom));
}

}  // namespace seamwright
