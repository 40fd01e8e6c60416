// Draws curves and bars with axes, grids and legends as SVG text.
#include "plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 440.0
#define COLORS 6      // classes c0 to c5
#define CHARACTER 6.1 // approximate width of a character

typedef struct axis {
  double low, high; // logarithms on a logarithmic axis
  double first_pixel, last_pixel;
  bool logarithmic;
} axis;

static void put_text(FILE *out, const char *text) {
  for (; *text; ++text) {
    switch (*text) {
    case '<': fputs("&lt;", out); break;
    case '>': fputs("&gt;", out); break;
    case '&': fputs("&amp;", out); break;
    case '"': fputs("&quot;", out); break;
    default: fputc(*text, out);
    }
  }
}

static void put_label(FILE *out, double x, double y, const char *attributes, const char *text) {
  fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, attributes);
  put_text(out, text);
  fputs("</text>", out);
}

static void put_line(FILE *out, const char *class_name, double x0, double y0, double x1, double y1) {
  fprintf(out, "<line class=\"%s\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>", class_name, x0, y0, x1, y1);
}

static bool drawable(double value, bool logarithmic) { return isfinite(value) && (!logarithmic || value > 0.0); }

static double place(const axis *a, double value) {
  const double position = a->logarithmic ? log10(value) : value;
  return a->first_pixel + (position - a->low) / (a->high - a->low) * (a->last_pixel - a->first_pixel);
}

// Returns the tick distance, 1, 2 or 5 times a power of ten, such that about `count` steps cover the range.
static double tick_step(double range, int count) {
  const double raw = range / count, power = pow(10.0, floor(log10(raw))), share = raw / power;
  return power * (share < 1.5 ? 1.0 : share < 3.5 ? 2.0 : share < 7.5 ? 5.0 : 10.0);
}

// Extends the axis to include the values, then to whole ticks.
static void include_values(axis *a, const double *values, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i) {
    if (!drawable(values[i], a->logarithmic)) continue;
    const double position = a->logarithmic ? log10(values[i]) : values[i];
    a->low = fmin(a->low, position);
    a->high = fmax(a->high, position);
  }
}

static double axis_step(const axis *a) {
  if (a->logarithmic) return fmax(1.0, round((a->high - a->low) / 5.0));
  return tick_step(a->high - a->low, 5);
}

static void round_axis(axis *a) {
  if (!(a->low <= a->high)) a->low = a->high = 0.0; // there are no values
  if (a->high - a->low < 1e-12 * fmax(1.0, fabs(a->low))) a->high = a->low + 1.0;
  const double step = axis_step(a);
  a->low = floor(a->low / step + 1e-9) * step;
  a->high = ceil(a->high / step - 1e-9) * step;
}

static uint32_t tick_count(const axis *a) { return (uint32_t)lround((a->high - a->low) / axis_step(a)) + 1; }

// Formats a power of ten with a superscript exponent.
static void power_label(int exponent, char text[32]) {
  static const char *const digits[10] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                         "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  char plain[12];
  int length = snprintf(text, 32, exponent < 0 ? "10\u207b" : "10");
  snprintf(plain, sizeof plain, "%d", abs(exponent));
  for (const char *c = plain; *c; ++c) length += snprintf(text + length, 32 - (size_t)length, "%s", digits[*c - '0']);
}

static double tick_at(const axis *a, uint32_t index, char text[32]) {
  const double step = axis_step(a), position = a->low + index * step;
  if (a->logarithmic && fabs(position) > 2.5) power_label((int)lround(position), text);
  else snprintf(text, 32, "%g", a->logarithmic ? pow(10.0, position) : fabs(position) < 1e-9 * step ? 0.0 : position);
  return a->first_pixel + (position - a->low) / (a->high - a->low) * (a->last_pixel - a->first_pixel);
}

static void begin(FILE *out, double height, const char *label) {
  fprintf(out, "<svg viewBox=\"0 0 %g %g\" role=\"img\" aria-label=\"", WIDTH, height);
  put_text(out, label);
  fputs("\">", out);
}

static void put_legend(FILE *out, const plot_series *series, uint32_t count) {
  double x = 8.0;
  if (count < 2) return;
  for (uint32_t i = 0; i < count; ++i) {
    fprintf(out, "<rect class=\"fill c%u\" x=\"%.1f\" y=\"5\" width=\"12\" height=\"4\" rx=\"2\"/>", i % COLORS, x);
    put_label(out, x + 18.0, 11.0, "class=\"name\"", series[i].name);
    x += 18.0 + CHARACTER * (double)strlen(series[i].name) + 14.0;
  }
}

static void put_grid(FILE *out, const line_plot *plot, const axis *x, const axis *y) {
  char text[32];
  for (uint32_t i = 0; i < tick_count(y); ++i) {
    const double at = tick_at(y, i, text);
    put_line(out, i == 0 ? "axis" : "grid", x->first_pixel, at, x->last_pixel, at);
    put_label(out, x->first_pixel - 8.0, at + 4.0, "text-anchor=\"end\"", text);
  }
  for (uint32_t i = 0; i < tick_count(x); ++i) {
    const double at = tick_at(x, i, text);
    put_line(out, "axis", at, y->first_pixel, at, y->first_pixel + 4.0);
    put_label(out, at, y->first_pixel + 18.0, "text-anchor=\"middle\"", text);
  }
  put_label(out, (x->first_pixel + x->last_pixel) / 2.0, y->first_pixel + 38.0, "class=\"name\" text-anchor=\"middle\"",
            plot->x_label);
  char attributes[96];
  const double middle = (y->first_pixel + y->last_pixel) / 2.0;
  snprintf(attributes, sizeof attributes, "class=\"name\" text-anchor=\"middle\" transform=\"rotate(-90 14 %.1f)\"",
           middle);
  put_label(out, 14.0, middle, attributes, plot->y_label);
}

static void put_curve(FILE *out, const line_plot *plot, uint32_t index, const axis *x, const axis *y) {
  const plot_series *s = &plot->series[index];
  bool drawing = false;
  fprintf(out, "<path class=\"curve c%u\" d=\"", index % COLORS);
  for (uint32_t i = 0; i < s->count; ++i) {
    const bool there = drawable(s->x[i], plot->log_x) && drawable(s->y[i], plot->log_y);
    if (there) fprintf(out, "%c%.1f %.1f", drawing ? 'L' : 'M', place(x, s->x[i]), place(y, s->y[i]));
    drawing = there;
  }
  fputs("\"/>", out);
  for (uint32_t i = 0; plot->markers && i < s->count; ++i) {
    if (!drawable(s->x[i], plot->log_x) || !drawable(s->y[i], plot->log_y)) continue;
    fprintf(out, "<circle class=\"fill c%u\" cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\"><title>", index % COLORS,
            place(x, s->x[i]), place(y, s->y[i]));
    put_text(out, s->name);
    fprintf(out, ": %g, %g</title></circle>", s->x[i], s->y[i]);
  }
}

static char *finish(FILE *out, char **text) {
  fputs("</svg>", out);
  const bool failed = ferror(out) != 0;
  if (fclose(out) == 0 && !failed) return *text;
  free(*text);
  return NULL;
}

char *plot_lines(const line_plot *plot) {
  char *text = NULL;
  size_t size_bytes;
  FILE *out = open_memstream(&text, &size_bytes);
  if (!out) return NULL;
  axis x = {INFINITY, -INFINITY, 58.0, WIDTH - 14.0, plot->log_x}, y = {INFINITY, -INFINITY, 210.0, 24.0, plot->log_y};
  for (uint32_t i = 0; i < plot->series_count; ++i) {
    include_values(&x, plot->series[i].x, plot->series[i].count);
    include_values(&y, plot->series[i].y, plot->series[i].count);
  }
  if (!plot->log_y) y.low = fmin(y.low, 0.0);
  round_axis(&x);
  round_axis(&y);
  begin(out, 254.0, plot->y_label);
  put_legend(out, plot->series, plot->series_count);
  put_grid(out, plot, &x, &y);
  for (uint32_t i = 0; i < plot->series_count; ++i) put_curve(out, plot, i, &x, &y);
  return finish(out, &text);
}

static void put_bar(FILE *out, const axis *x, uint32_t color, double top, double value) {
  if (!isfinite(value)) return;
  const double zero = place(x, 0.0), end = place(x, value);
  fprintf(out, "<rect class=\"fill c%u\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"14\" rx=\"2\"/>", color % COLORS,
          fmin(zero, end), top, fmax(fabs(end - zero), 1.0));
  char label[32];
  snprintf(label, sizeof label, fabs(value) >= 1000.0 && fabs(value) < 1e7 ? "%.0f" : "%.3g", value);
  put_label(out, value < 0.0 ? end - 6.0 : end + 6.0, top + 11.0,
            value < 0.0 ? "class=\"value\" text-anchor=\"end\"" : "class=\"value\"", label);
}

char *plot_bars(const bar_plot *plot) {
  char *text = NULL;
  size_t size_bytes;
  FILE *out = open_memstream(&text, &size_bytes);
  if (!out) return NULL;
  axis x = {0.0, 0.0, 64.0, WIDTH - 64.0, false};
  double longest = 0.0;
  for (uint32_t i = 0; i < plot->name_count; ++i) longest = fmax(longest, (double)strlen(plot->names[i]));
  for (uint32_t i = 0; i < plot->series_count; ++i) include_values(&x, plot->series[i].y, plot->name_count);
  const double labels = fmin(CHARACTER * longest + 14.0, 0.65 * WIDTH);
  x.first_pixel = labels + (x.low < 0.0 ? 56.0 : 0.0); // space for the labels of bars to the left
  round_axis(&x);
  const double top = plot->series_count > 1 ? 26.0 : 8.0, row = 16.0 * plot->series_count + 14.0;
  const double bottom = top + row * plot->name_count;
  begin(out, bottom + 28.0, plot->label);
  put_legend(out, plot->series, plot->series_count);
  for (uint32_t i = 0; i < plot->name_count; ++i) {
    const double y = top + row * i + 7.0;
    put_label(out, labels - 14.0, y + (row - 14.0) / 2.0 + 4.0, "class=\"name\" text-anchor=\"end\"", plot->names[i]);
    for (uint32_t s = 0; s < plot->series_count; ++s) put_bar(out, &x, s, y + 16.0 * s + 1.0, plot->series[s].y[i]);
  }
  put_line(out, "axis", place(&x, 0.0), top, place(&x, 0.0), bottom);
  put_label(out, (x.first_pixel + x.last_pixel) / 2.0, bottom + 18.0, "class=\"name\" text-anchor=\"middle\"",
            plot->label);
  return finish(out, &text);
}
