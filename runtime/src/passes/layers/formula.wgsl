// The relief that formulas say.
    rise += SLOPE(layers.relief);
