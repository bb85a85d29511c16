// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "commands.h"
#include "errors.h"
#include "ltmd/errors.h"
#include "ltmd/mdf_conversion.h"

namespace ltmd::cli {
namespace {

struct Options {
    std::string source, target, method = mdf_method_names.front();
    std::vector<double> values;
    double gamma = 2;
    bool list = false;
};

void list_parameters() {
    for (const MdfParameterInfo& parameter : mdf_parameters)
        std::printf("%-20s %s, %g to %g\n", parameter.name, parameter.meaning, parameter.low,
                    parameter.high);
}

int run(const Options& options) {
    if (options.list) {
        list_parameters();
        return success;
    }
    if (options.values.empty() || options.target.empty())
        throw UsageError(
            "a conversion needs a parameter, values and --to, such as 'ltmd convert "
            "phong_exponent 120 --to ggx_alpha'; --list shows the parameters");
    try {
        const MdfConversion conversion(parse_mdf_parameter(options.source),
                                       parse_mdf_parameter(options.target),
                                       parse_mdf_method(options.method), options.gamma);
        std::vector<double> out(options.values.size());
        conversion(options.values, out);
        for (const double value : out) std::printf("%.7g\n", value);
    } catch (const InvalidInput& error) {
        throw UsageError(error.what());
    }
    return success;
}

}  // namespace

Command add_convert(CLI::App& app) {
    CLI::App* parser =
        app.add_subcommand("convert",
                           "Convert a roughness parameter to another's, one line for each value: "
                           "ltmd convert phong_exponent 120 --to ggx_alpha");
    const auto options = std::make_shared<Options>();
    parser->add_option("PARAMETER", options->source, "What is given; --list shows all");
    parser->add_option("VALUE", options->values, "Its values");
    parser->add_option("--to", options->target, "The parameter wanted");
    parser
        ->add_option("--method", options->method,
                     "rmse: least squares of D/D(0); half_angle: the same angle where it is 1/2; "
                     "closed_form: the published formulas for rmse; ward: m^2 N = 2, Beckmann and "
                     "Phong only")
        ->capture_default_str();
    parser->add_option("--gamma", options->gamma, "The exponent of gtr_alpha, 0.5 to 16")
        ->capture_default_str();
    parser->add_flag("--list", options->list, "Print the parameters and what they mean");
    return {parser, [options] { return run(*options); }};
}

}  // namespace ltmd::cli
