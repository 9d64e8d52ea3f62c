// fit_test.cpp: lines, unloading branches and laws of modulus against porosity recover what they were made of.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "core/types.h"
#include "tests/physics/relative.h"
#include "analysis/law_fit.h"
#include "analysis/line_fit.h"
#include "analysis/student.h"
#include "analysis/unloading.h"

using namespace kiln::analysis;
using namespace kiln::physics;
using kiln::test::relative;

namespace {

const std::vector<double> porosity{0.33, 0.29, 0.21, 0.12, 0.05};
const std::vector<double> alike(porosity.size(), 1.0);

std::vector<double> moduli(const PorosityLaw& law, const std::vector<double>& parameters,
                           const std::vector<double>& at = porosity) {
    std::vector<double> values;
    for (const double p : at) values.push_back(law.modulus(p, parameters));
    return values;
}

}  // namespace

TEST_CASE("fit: a line through exact points, and the error of a slope by hand") {
    const std::vector<double> x{1.0, 2.0, 3.0}, exact{5.0, 7.0, 9.0}, bent{5.0, 8.0, 9.0};
    CHECK(fit_line(x, exact).slope == relative(2.0, 1e-12));
    CHECK(fit_line(x, exact).intercept == relative(3.0, 1e-12));
    CHECK(std::abs(fit_line(x, exact).slope_error) < 1e-12);
    // Residuals -1/3, 2/3, -1/3: sum of squares 2/3, one degree of freedom, sum of (x - 2)^2 is 2.
    CHECK(fit_line(x, bent).slope == relative(2.0, 1e-12));
    CHECK(fit_line(x, bent).slope_error == relative(std::sqrt(1.0 / 3.0), 1e-12));
    CHECK(std::isnan(fit_line(std::vector{1.0, 2.0}, std::vector{1.0, 3.0}).slope_error));
}

TEST_CASE("fit: every law recovers its own parameters") {
    for (const PorosityLaw& law : porosity_laws()) {
        CAPTURE(law.name);
        for (const double scale : {1.0, 1e9}) {
            std::vector<double> made{410.0 * scale, 1.4};
            made.resize(law.parameters.size());
            const Fit fit = fit_law(law, porosity, moduli(law, made), alike);
            for (std::size_t k = 0; k < made.size(); ++k) CHECK(fit.parameters[k] == relative(made[k], 1e-10));
            CHECK(fit.r_squared == relative(1.0, 1e-12));
            CHECK(fit.degrees_of_freedom == porosity.size() - made.size());
            REQUIRE(fit.covariance);
            CHECK(std::sqrt((*fit.covariance)(0, 0)) < 1e-8 * made[0]);
        }
    }
}

TEST_CASE("fit: the straight law has the errors of linear regression") {
    const std::vector<double> noisy{0.62, 0.66, 0.75, 0.89, 0.93};
    const Fit fit = fit_law(porosity_law("linear"), porosity, noisy, alike);
    const Line line = fit_line(porosity, noisy);
    CHECK(fit.parameters[0] == relative(line.intercept, 1e-9));
    CHECK(fit.parameters[0] * fit.parameters[1] == relative(-line.slope, 1e-9));
    // Error of the slope E0 b by propagation from the covariance of E0 and b.
    const Eigen::Vector2d gradient(fit.parameters[1], fit.parameters[0]);
    CHECK(std::sqrt(gradient.dot(*fit.covariance * gradient)) == relative(line.slope_error, 1e-6));
}

TEST_CASE("fit: parameters of noisy points lie within their stated errors as often as they should") {
    const PorosityLaw& law = porosity_law("knudsen");
    const std::vector<double> made{410e9, 3.95};
    std::vector<double> at, weight;
    for (int point = 0; point < 30; ++point) at.push_back(0.05 + 0.01 * point);
    const std::vector<double> clean = moduli(law, made, at);
    std::mt19937_64 random(12345);
    std::normal_distribution<double> normal;
    for (const double modulus : clean) weight.push_back(1.0 / (modulus * modulus));
    int within_one = 0, within_two = 0;
    constexpr int trials = 400;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<double> noisy = clean;
        for (double& modulus : noisy) modulus *= 1.0 + 0.03 * normal(random);
        const Fit fit = fit_law(law, at, noisy, weight);
        const double off = std::abs(fit.parameters[1] - made[1]) / std::sqrt((*fit.covariance)(1, 1));
        within_one += off < 1.0;
        within_two += off < 2.0;
    }
    CHECK(within_one / double(trials) == relative(0.68, 0.1));
    CHECK(within_two / double(trials) == relative(0.95, 0.03));
}

TEST_CASE("fit: a point of great weight draws the law to itself, and common factors of the weights do not matter") {
    const std::vector<double> noisy{0.30, 0.34, 0.44, 0.65, 0.80};
    std::vector<double> heavy(alike), scaled(alike);
    heavy[3] = 1e8;
    for (double& weight : scaled) weight *= 1e-18;
    const PorosityLaw& law = porosity_law("knudsen");
    CHECK(std::abs(fit_law(law, porosity, noisy, heavy).residuals[3]) < 1e-6);
    const Fit one = fit_law(law, porosity, noisy, alike), two = fit_law(law, porosity, noisy, scaled);
    CHECK(two.parameters[1] == relative(one.parameters[1], 1e-12));
    CHECK((*two.covariance)(1, 1) == relative((*one.covariance)(1, 1), 1e-9));
}

TEST_CASE("fit: too few points, points alike, no freedom") {
    const PorosityLaw& law = porosity_law("knudsen");
    CHECK_THROWS_WITH_AS(fit_law(law, std::vector{0.1}, std::vector{1.0}, std::vector{1.0}), doctest::Contains("only 1 points"),
                         kiln::Error);
    CHECK_THROWS_WITH_AS(fit_law(law, std::vector{0.1, 0.1, 0.1}, std::vector{1.0, 1.1, 0.9}, std::vector{1.0, 1.0, 1.0}),
                         doctest::Contains("do not determine"), kiln::Error);
    const Fit fit = fit_law(law, std::vector{0.1, 0.2}, std::vector{2.0, 1.0}, std::vector{1.0, 1.0});
    CHECK(fit.parameters[1] == relative(std::log(2.0) / 0.1, 1e-12));
    CHECK_FALSE(fit.covariance);
    CHECK_THROWS_WITH_AS(porosity_law("knutsen"), doctest::Contains("knudsen, spriggs, coble-kingery"), kiln::Error);
}

TEST_CASE("fit: a law of one parameter through points of one density is their mean, with its standard error") {
    const std::vector<double> porosity(3, 0.2), modulus{200.0, 210.0, 220.0}, weight(3, 1.0);
    const Fit fit = fit_law(porosity_law("gibson-ashby"), porosity, modulus, weight);
    CHECK(fit.parameters[0] == relative(210.0 / 0.64, 1e-10));
    REQUIRE(fit.covariance);
    CHECK(std::sqrt((*fit.covariance)(0, 0)) == relative(10.0 / std::sqrt(3.0) / 0.64, 1e-8));
}

TEST_CASE("fit: the law that made the points has the least AICc, and its band holds a law near by") {
    const std::vector<double> at{0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4}, weights(at.size(), 1.0);
    const PorosityLaw& made_by = porosity_law("pabst");
    std::vector<double> points = moduli(made_by, {400.0, 0.6}, at);
    for (std::size_t point = 0; point < at.size(); ++point) points[point] += point % 2 == 0 ? 1.0 : -1.0;
    const Fit best = fit_law(made_by, at, points, weights);
    REQUIRE(best.aicc);
    for (const PorosityLaw& law : porosity_laws()) {
        CAPTURE(law.name);
        if (law.name != "pabst") CHECK(*fit_law(law, at, points, weights).aicc > *best.aicc + 5.0);
    }
    // n = 8, k = 3: 2 k + 2 k (k + 1)/(n - k - 1)
    CHECK(*best.aicc - 8.0 * std::log(best.scatter * 6.0 / 8.0) == relative(6.0 + 6.0, 1e-12));
    for (const double p : {0.0, 0.2, 0.5}) {
        const double off = made_by.modulus(p, best.parameters) - made_by.modulus(p, std::vector{400.0, 0.6});
        CHECK(std::abs(off) < 3.0 * error_at(made_by, best, p));
    }
}

TEST_CASE("fit: the error of a straight law is that of regression, everywhere") {
    const std::vector<double> noisy{0.62, 0.66, 0.75, 0.89, 0.93};
    const PorosityLaw& law = porosity_law("linear");
    const Fit fit = fit_law(law, porosity, noisy, alike);
    double mean = 0.0, squares = 0.0;
    for (const double p : porosity) mean += p / 5.0;
    for (const double p : porosity) squares += (p - mean) * (p - mean);
    for (const double p : {0.0, 0.2, 0.4})
        CHECK(error_at(law, fit, p) == relative(std::sqrt(fit.scatter * (0.2 + (p - mean) * (p - mean) / squares)), 1e-6));
}

TEST_CASE("fit: Student's factors of the tables") {
    CHECK(student_factor(1, 0.95) == relative(12.706, 1e-4));
    CHECK(student_factor(4, 0.95) == relative(2.7764, 1e-4));
    CHECK(student_factor(30, 0.99) == relative(2.750, 1e-4));
}

// Each curve states a 95 % interval. Of 100 seeds the modulus must lie in it about 95 times; this count has a standard deviation
// of 2.2, so the seeds are many, and the share is asked for within three of its own standard deviations.
TEST_CASE("fit: the modulus of a noisy unloading lies in its 95 % interval in 95 of 100 cases") {
    constexpr int trials = 2000, points = 12;
    constexpr double slope = 1e6;
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    int inside = 0;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<double> deflection, force;
        for (int point = 0; point < points; ++point) {
            deflection.push_back(1e-6 * (50 - 3 * point));
            force.push_back(slope * deflection.back() + 0.5 * normal(random));
        }
        const Line line = fit_line(deflection, force);
        inside += std::abs(line.slope - slope) < student_factor(points - 2, 0.95) * line.slope_error;
    }
    CHECK(inside / double(trials) == relative(0.95, 0.015));
}

TEST_CASE("unloading: tremor of a reading is no turn of the punch") {
    std::vector<double> travel;
    for (int point = 0; point <= 100; ++point) travel.push_back(point + (point % 2 == 0 ? 0.6 : -0.6));
    for (int point = 99; point >= 0; --point) travel.push_back(point + (point % 2 == 0 ? 0.6 : -0.6));
    const auto branch = last_unloading(travel);
    REQUIRE(branch);
    CHECK(branch->first == 100);
    CHECK(branch->last >= 199);
}

TEST_CASE("unloading: the last stretch on which the punch goes back") {
    const std::vector<double> two_cycles{0, 1, 2, 1, 0, 1, 3, 2, 1};
    const auto branch = last_unloading(two_cycles);
    REQUIRE(branch);
    CHECK(branch->first == 6);
    CHECK(branch->last == 8);
    const std::vector<double> ends_loading{0, 1, 2, 1, 0, 1, 3};
    CHECK(last_unloading(ends_loading)->first == 2);
    CHECK(last_unloading(ends_loading)->last == 4);
    CHECK_FALSE(last_unloading(std::vector{0.0, 1.0, 2.0}));
    CHECK_FALSE(last_unloading(std::vector<double>{}));
}

TEST_CASE("loading: the last rise, as far as its largest force") {
    const std::vector<double> travel{0, 1, 2, 1, 0, 1, 2, 3, 4}, force{0, 1, 2, 1, 0, 1, 2, 3, 2.5};
    const auto branch = last_loading(travel, force);
    REQUIRE(branch);
    CHECK(branch->first == 4);
    CHECK(branch->last == 7);
    CHECK_FALSE(last_loading(std::vector{2.0, 1.0, 0.0}, std::vector{2.0, 1.0, 0.0}));
    CHECK_FALSE(last_loading(std::vector<double>{}, std::vector<double>{}));
}

TEST_CASE("break: the force falls to less than half while the punch stays or goes on") {
    // Slack, a rise, and the fall at the same travel, further on, or a little back; then the machine returns under rest forces.
    for (const double at_break : {6.0, 6.3, 5.95}) {
        const std::vector<double> travel{0, 1, 2, 3, 4, 5, 6, at_break, 4, 2, 0}, force{0, 0, 0, 10, 20, 30, 40, 2, 1.5, 1, 0.5};
        CAPTURE(at_break);
        CHECK(point_before_break(travel, force) == std::size_t{6});
    }
    const std::vector<double> softening{0, 1, 2, 3, 4, 5, 6}, less{0, 20, 40, 36, 30, 24, 15};
    CHECK(point_before_break(softening, less) == std::size_t{2});
    const std::vector<double> cycles{0, 1, 2, 1, 0, 1, 2, 3, 3}, broken_at_last{0, 20, 40, 20, 0, 20, 39, 38, 1};
    CHECK(point_before_break(cycles, broken_at_last) == std::size_t{6});
}

TEST_CASE("break: unloading, reloading and what rattles at small forces is none") {
    const std::vector<double> cycles{0, 1, 2, 3, 2, 1, 0, 1, 2, 3, 4, 3, 2, 1, 0},
        force{0, 10, 20, 30, 20, 10, 0, 10, 20, 30, 40, 30, 20, 10, 0};
    CHECK_FALSE(point_before_break(cycles, force));
    const std::vector<double> stiff{0, 1, 2, 3, 2.8, 2.6, 2.4}, hysteresis{0, 10, 20, 30, 15, 6, 0};
    CHECK_FALSE(point_before_break(stiff, hysteresis));
    const std::vector<double> travel{0, 0.1, 0.2, 0.3, 1, 2, 3}, rattling{0, 2, 0, 3, 10, 20, 30};
    CHECK_FALSE(point_before_break(travel, rattling));
    CHECK_FALSE(point_before_break(std::vector<double>{}, std::vector<double>{}));
}

TEST_CASE("misfit: a line must grow, explain its points, and not bend") {
    std::vector<double> deflection, straight, bent, scattered, falling;
    for (int point = 0; point < 12; ++point) {
        deflection.push_back(point);
        straight.push_back(5.0 + 2.0 * point + (point % 2 == 0 ? 0.1 : -0.1));
        bent.push_back(point < 6 ? point : 6 + 2 * (point - 6));
        scattered.push_back(point + (point % 2 == 0 ? 4.0 : -4.0));
        falling.push_back(-point);
    }
    const auto said = [&](const std::vector<double>& force) {
        return misfit(fit_line(deflection, force), deflection, force).value_or("");
    };
    CHECK(said(straight) == "");
    CHECK(said(bent) == "the curve bends: the slopes of its halves differ by more than a factor of 1.5");
    CHECK(said(scattered).starts_with("a straight line explains only "));
    CHECK(said(falling) == "the force does not grow with the deflection");
    CHECK(said(std::vector<double>(12, 3.0)) == "the force does not grow with the deflection");
    CHECK(fit_line(std::vector{0.0, 1.0, 2.0}, std::vector{0.0, 2.0, 1.0}).r_squared == relative(0.25, 1e-14));
}

TEST_CASE("unloading: the window is taken of the branch's own peak, ends included") {
    const std::vector<double> force{0, 100, 0, 60, 50, 40, 20, 10};
    CHECK(points_in(force, {3, 7}, Window()) == std::vector<std::size_t>{4, 5, 6});
    CHECK(points_in(force, {3, 7}, {1.0, 0.0}) == std::vector<std::size_t>{3, 4, 5, 6, 7});
}

TEST_CASE("unloading: windows as text") {
    CHECK(parse_window("5/6:1/3").upper == relative(5.0 / 6.0, 1e-12));
    CHECK(parse_window("5/6:1/3").lower == relative(1.0 / 3.0, 1e-12));
    CHECK(parse_window("1:0").lower == 0.0);
    CHECK(parse_window("0.8:0.2").upper == relative(0.8, 1e-12));
    for (const char* wrong : {"", "5/6", "1/3:5/6", "2:1", "0.5:-1", "a:b", "1/0:0", "0.8:0.2:0.1", "0.8 :0.2"}) {
        CAPTURE(wrong);
        CHECK_THROWS_AS(parse_window(wrong), kiln::TextError);
    }
}
