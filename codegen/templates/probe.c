
/* Weighted sums of made-up inputs: leaves of trees hide small differences of features. */
static int probe_differs(void)
{
    enum {
        N_INPUTS = @INPUTS@ < 64 ? @INPUTS@ : 64
    };
    sp_real in[N_INPUTS];
    pattern out[N_LANES];
    sp_real sums[N_LANES];
    for (uint32_t k = 0; k < N_INPUTS; k++) {
        in[k] = (sp_real)(37 * k % 101) / (sp_real)128;
    }
    sp_weigh(@WEIGHTS@, in, N_INPUTS, N_LANES, sums);
    for (uint32_t i = 0; i < N_LANES; i++) {
        out[i].real = sums[i];
        if (out[i].bits != golden_probe[i]) {
            return 1;
        }
    }
    return 0;
}
