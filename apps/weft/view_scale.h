#pragma once
/// Ends of scales that follow what is shown.

namespace weft::engine::app {

/// 1, 2 or 5 times a power of ten, at least `value`; 1 for values up to 0.
double round_up(double value);

/// A round number that the values do not exceed. It grows at once, and shrinks only when they are far smaller, so
/// that colours keep their meaning from picture to picture.
class RoundScale {
 public:
  double end() const { return end_; }  // > 0
  void update(double largest);         // of the values; 0 and less: none
  void forget() { is_new_ = true; }

 private:
  double end_ = 1;
  bool is_new_ = true;
};

}  // namespace weft::engine::app
