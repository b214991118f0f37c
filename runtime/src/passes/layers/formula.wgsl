// The relief that formulas say.
    rise += layers.relief;
