// SPDX-License-Identifier: Apache-2.0
#include "ltmd/unit_mdf.h"

#include <string>

#include "ltmd/errors.h"
#include "ltmd/require_range.h"
#include "text.h"
#include "unit_form.h"

namespace ltmd::inline v0 {

MdfParameter parse_mdf_parameter(std::string_view name) {
    std::string names;
    for (std::size_t i = 0; i < mdf_parameters.size(); ++i) {
        if (name == mdf_parameters[i].name) return static_cast<MdfParameter>(i);
        names += text(i == 0 ? "" : ", ", mdf_parameters[i].name);
    }
    throw InvalidInput(text("there is no parameter '", name, "'; the names are ", names));
}

double unit_mdf(MdfParameter parameter, double value, double beta, double gamma) {
    const MdfParameterInfo& info = mdf_info(parameter);
    require_range(info.name, value, info.low, info.high);
    if (parameter == MdfParameter::gtr_alpha)
        require_range("gamma", gamma, smallest_mdf_gamma, largest_mdf_gamma);
    return unit_form(parameter, gamma).at(family_value(parameter, value), beta).value;
}

}  // namespace ltmd::inline v0
