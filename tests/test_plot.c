// Tests where the curves and bars of a report's plots are, by the numbers in the SVG.
#include "plot.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct point {
  double x, y;
} point;

// Reads the points of the first curve; returns how many there are, and in *strokes the number of pieces that it is
// drawn in.
static int read_curve(const char *svg, point points[16], int *strokes) {
  const char *text = strstr(svg, "<path class=\"curve c0\" d=\"");
  assert_non_null(text);
  text += strlen("<path class=\"curve c0\" d=\"");
  int count = 0;
  *strokes = 0;
  for (char *next; *text == 'M' || *text == 'L'; text = next) {
    if (*text == 'M') *strokes += 1;
    assert_true(count < 16);
    points[count].x = strtod(text + 1, &next);
    points[count++].y = strtod(next, &next);
  }
  assert_int_equal(*text, '"');
  return count;
}

static int count_of(const char *svg, const char *what) {
  int count = 0;
  for (const char *at = svg; (at = strstr(at, what)); at += strlen(what)) ++count;
  return count;
}

static void a_power_law_is_straight_on_logarithmic_axes(void **state) {
  (void)state;
  const double x[] = {1, 10, 100, 1000}, y[] = {0.5, 0.005, 0.00005, 0.0000005};
  const plot_series series = {"error", x, y, 4};
  const line_plot plot = {.x_label = "probes",
                          .y_label = "MSE",
                          .log_x = true,
                          .log_y = true,
                          .markers = true,
                          .series = &series,
                          .series_count = 1};
  char *svg = plot_lines(&plot);
  point p[16];
  int strokes;
  assert_int_equal(read_curve(svg, p, &strokes), 4);
  assert_int_equal(strokes, 1);
  for (int i = 1; i < 4; ++i) {
    assert_true(fabs((p[i].x - p[i - 1].x) - (p[1].x - p[0].x)) < 0.11); // coordinates are written with one decimal
    assert_true(fabs((p[i].y - p[i - 1].y) - (p[1].y - p[0].y)) < 0.11);
  }
  assert_true(p[1].x > p[0].x && p[1].y > p[0].y);
  assert_int_equal(count_of(svg, "<circle "), 4);
  assert_non_null(strstr(svg, "error: 100, 5e-05</title>"));
  free(svg);
}

static void values_that_cannot_be_drawn_leave_gaps(void **state) {
  (void)state;
  const double x[] = {1, 2, 3, 4, 5, 6}, y[] = {1, NAN, 2, 3, INFINITY, 1};
  plot_series series = {"a", x, y, 6};
  line_plot plot = {.x_label = "x", .y_label = "y", .series = &series, .series_count = 1};
  point p[16];
  int strokes;
  char *svg = plot_lines(&plot);
  assert_int_equal(read_curve(svg, p, &strokes), 4);
  assert_int_equal(strokes, 3);
  free(svg);
  const double zeros[] = {0, 1, 10, -1, 100, 0};
  series.y = zeros;
  plot.log_y = true;
  svg = plot_lines(&plot);
  assert_int_equal(read_curve(svg, p, &strokes), 3);
  assert_int_equal(strokes, 2);
  assert_null(strstr(svg, "nan"));
  assert_null(strstr(svg, "inf"));
  free(svg);
}

static void axes_hold_every_value_and_linear_ones_begin_at_zero(void **state) {
  (void)state;
  const double x[] = {3, 17}, y[] = {40, 90};
  const plot_series series = {"a", x, y, 2};
  const line_plot plot = {.x_label = "x", .y_label = "y", .series = &series, .series_count = 1};
  char *svg = plot_lines(&plot);
  point p[16];
  int strokes;
  read_curve(svg, p, &strokes);
  for (int i = 0; i < 2; ++i) assert_true(p[i].x >= 58.0 && p[i].x <= 426.0 && p[i].y >= 24.0 && p[i].y <= 210.0);
  // The y axis is linear, from 0 at the bottom.
  assert_true(fabs((210.0 - p[1].y) / (210.0 - p[0].y) - 90.0 / 40.0) < 0.01);
  free(svg);
}

static void bars_are_as_long_as_their_numbers_on_both_sides_of_zero(void **state) {
  (void)state;
  const char *names[] = {"one", "two", "three", "none"};
  const double values[] = {10, 40, -20, NAN};
  const plot_series series = {.name = "bias", .y = values, .count = 4};
  const bar_plot plot = {.label = "bias, %", .names = names, .name_count = 4, .series = &series, .series_count = 1};
  char *svg = plot_bars(&plot);
  double start[3], length[3];
  const char *at = svg;
  for (int i = 0; i < 3; ++i) {
    at = strstr(at, "<rect class=\"fill c0\" x=\"");
    assert_non_null(at);
    assert_int_equal(sscanf(at, "<rect class=\"fill c0\" x=\"%lf\" y=\"%*f\" width=\"%lf\"", &start[i], &length[i]), 2);
    ++at;
  }
  assert_int_equal(count_of(svg, "<rect "), 3);
  assert_true(fabs(length[1] / length[0] - 4.0) < 0.02 && fabs(length[2] / length[0] - 2.0) < 0.02);
  assert_true(start[0] == start[1]);
  assert_true(fabs(start[2] + length[2] - start[0]) < 0.11);
  free(svg);
}

static void text_is_escaped_and_series_are_named(void **state) {
  (void)state;
  const double x[] = {0, 1}, y[] = {0, 1};
  const plot_series series[] = {{"<b>&\"", x, y, 2}, {"plain", x, y, 2}};
  const line_plot plot = {.x_label = "a < b", .y_label = "\"y\"", .series = series, .series_count = 2};
  char *svg = plot_lines(&plot);
  assert_non_null(strstr(svg, "&lt;b&gt;&amp;&quot;</text>"));
  assert_non_null(strstr(svg, "plain</text>"));
  assert_non_null(strstr(svg, "a &lt; b</text>"));
  assert_null(strstr(svg, "<b>"));
  free(svg);
}

static void plots_of_nothing_are_empty(void **state) {
  (void)state;
  const double x[] = {1}, y[] = {NAN};
  const plot_series series = {"a", x, y, 1};
  line_plot plot = {.x_label = "x", .y_label = "y", .log_x = true, .series = &series, .series_count = 1};
  for (int i = 0; i < 4; ++i) {
    plot.log_y = i & 1;
    plot.series_count = i < 2 ? 1 : 0;
    char *svg = plot_lines(&plot);
    assert_non_null(svg);
    assert_null(strstr(svg, "nan"));
    assert_true(strlen(svg) < 8192);
    free(svg);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_power_law_is_straight_on_logarithmic_axes),
      cmocka_unit_test(values_that_cannot_be_drawn_leave_gaps),
      cmocka_unit_test(axes_hold_every_value_and_linear_ones_begin_at_zero),
      cmocka_unit_test(bars_are_as_long_as_their_numbers_on_both_sides_of_zero),
      cmocka_unit_test(text_is_escaped_and_series_are_named),
      cmocka_unit_test(plots_of_nothing_are_empty),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
