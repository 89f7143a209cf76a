// soft_pad.c in C#, for Unity and others: build it as a library first, then mcs SoftPad.cs.
//
//     cc -O2 -shared -fPIC -o libsoft_pad.so soft_pad.c -lm
using System;
using System.Runtime.InteropServices;

/// One object, pressed at several points: a state for each.
sealed class Point : IDisposable
{
    [DllImport("soft_pad")] static extern uint soft_pad_state_size();
    [DllImport("soft_pad")] static extern int soft_pad_selftest();
    [DllImport("soft_pad")] static extern void soft_pad_init(IntPtr state);
    [DllImport("soft_pad")] static extern int soft_pad_step(IntPtr state, float position_m, float velocity_mps, out float force_n);
    [DllImport("soft_pad")] static extern void soft_pad_reset(IntPtr state);

    const float RateHz = 1000.0f;      // SOFT_PAD_RATE_HZ of soft_pad.h
    const float LongestHitchS = 0.1f;  // a longer one is a pause

    readonly IntPtr state = Marshal.AllocHGlobal((int)soft_pad_state_size());
    float owed_s, last_m, last_n;

    public int Notes { get; private set; }

    public Point()
    {
        if (soft_pad_selftest() != 0)
        {
            throw new InvalidOperationException("this build gives other forces: render none");
        }
        soft_pad_init(state);
    }

    public float Step(float position_m, float velocity_mps)
    {
        Notes = soft_pad_step(state, position_m, velocity_mps, out float force_n);
        return Notes < 0 ? 0.0f : force_n;
    }

    /// For a force that no hand feels: the ticks of the time that went by, on a straight line.
    public float Advance(float position_m, float elapsed_s)
    {
        owed_s = Math.Min(owed_s + elapsed_s, LongestHitchS);
        int ticks = (int)(owed_s * RateHz);
        float way_m = position_m - last_m;
        for (int tick = 1; tick <= ticks; tick++)
        {
            last_n = Step(last_m + way_m * tick / ticks, way_m * RateHz / ticks);
        }
        if (ticks > 0)
        {
            owed_s -= ticks / RateHz;
            if (!float.IsNaN(way_m) && !float.IsInfinity(way_m))  // else held: Notes has 1
            {
                last_m = position_m;
            }
        }
        return last_n;
    }

    /// After a pause, and where Notes has 32 (latched): the force comes back as a ramp.
    public void Reset() { soft_pad_reset(state); }

    public void Dispose() { Marshal.FreeHGlobal(state); }
}

static class Program
{
    static void Main()
    {
        using (Point left = new Point(), right = new Point(), alone = new Point())
        {
            for (int tick = 0; tick <= 400; tick++)
            {
                float position_m = 0.004f * tick / 400;
                float force_n = left.Step(position_m, 0.01f);
                right.Step(0.5f * position_m, 0.005f);
                if (force_n != alone.Step(position_m, 0.01f))
                {
                    throw new InvalidOperationException("two points share something");
                }
                if (tick % 100 == 0)
                {
                    Console.WriteLine("{0:F4} m {1:F3} N", position_m, force_n);
                }
            }
        }
        using (Point drawn = new Point())
        {
            float force_n = 0.0f;
            for (int picture = 1; picture <= 36; picture++)  // 0.4 s at 90 Hz
            {
                force_n = drawn.Advance(0.004f * picture / 36, 1.0f / 90.0f);
            }
            Console.WriteLine("drawn {0:F3} N", force_n);
        }
    }
}
